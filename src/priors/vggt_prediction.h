// VGGT on photos: a camera, dense depth and its confidence for each, in the photos' own pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/memory_budget.h"
#include "core/progress.h"
#include "nn/compute.h"
#include "nn/preprocess/vggt_images.h"
#include "nn/vggt.h"
#include "priors/photo_folder.h"
#include "priors/predicted_view.h"

namespace aligngs {

/// The photos as the network is given them, and where each lies in its input.
struct VggtInputs {
  std::vector<Image<uint8_t>> images;  ///< all of one size
  std::vector<nn::VggtPlacement> placements;
};
/// Landscape photos as its loader makes them (width 518); portraits, or both mixed, padded with
/// white to 518 x 518.
VggtInputs vggt_inputs(const std::vector<Photo>& photos, ThreadPool& pool);

/// Memory for running the network beside the photos, item by item.
void add_vggt_memory(MemoryBudget& budget, const nn::Weights& weights, nn::Precision precision, size_t frames,
                     int width, int height);

/// Error{kFailed}, naming the photo, when a predicted camera is impossible. Examples: a field of
/// view of 0 or of half a turn and more, numbers that are not finite.
std::vector<PredictedView> predict_vggt_views(nn::Compute& compute, const nn::Vggt& network,
                                              const std::vector<Photo>& photos, VggtInputs inputs,
                                              const ViewPredictionOptions& options);

}  // namespace aligngs
