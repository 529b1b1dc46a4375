// Depth Anything 3 on photos: a camera, dense depth and its confidence for each, in the photos' own pixels.
#pragma once

#include <vector>

#include "core/memory_budget.h"
#include "nn/compute.h"
#include "nn/da3/da3.h"
#include "priors/predicted_view.h"

namespace aligngs {

/// The photos as the network is given them, and where each lies in its input.
struct Da3Inputs {
  std::vector<Image<uint8_t>> images;  ///< all of one size
  std::vector<nn::ImagePlacement> placements;
};
/// Longest side 504, as its program prepares them. Photos of several shapes are cut to what all have, in the middle.
Da3Inputs da3_inputs(const std::vector<Photo>& photos, ThreadPool& pool);

/// What running the network will need beside the photos, item by item. Reads shapes only.
void add_da3_memory(MemoryBudget& budget, const nn::Weights& weights, nn::Precision precision, size_t frames, int width,
                    int height);

/// Depth and translations are in units of the network, which are arbitrary. Error{kFailed} when a predicted camera is
/// impossible, naming the photo.
std::vector<PredictedView> predict_da3_views(nn::Compute& compute, const nn::Da3& network,
                                             const std::vector<Photo>& photos, Da3Inputs inputs,
                                             const ViewPredictionOptions& options);

/// Depth for views whose cameras are known (at the size of the photos): the network reads them, and its depth is
/// brought to their units by least squares over the centres. The cameras stay as they are. Error{kFailed} when the
/// network's own cameras do not fit the given ones at all.
std::vector<PredictedView> da3_depth_of_cameras(nn::Compute& compute, const nn::Da3& network,
                                                const std::vector<Photo>& photos, const std::vector<Camera>& cameras,
                                                Da3Inputs inputs, const ProgressStyle& style);

}  // namespace aligngs
