// VGGT on photos: a camera, dense depth and its confidence for each, in the photos' own pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/memory_budget.h"
#include "core/progress.h"
#include "nn/compute.h"
#include "nn/preprocess/vggt_images.h"
#include "nn/vggt.h"
#include "priors/photo_folder.h"
#include "scene/camera.h"

namespace aligngs {

struct VggtView {
  Camera camera;      ///< at the size of the photo; the first view's pose is the identity
  ImageF depth;       ///< scene units (arbitrary), aspect of the photo; 0: outside of the network's view
  ImageF confidence;  ///< 1 (none) upwards, same size; 0 where depth is
};

struct VggtPredictionOptions {
  /// All views get the median focal length: for photos of one camera without zoom.
  bool shared_focal = false;
  ProgressStyle progress;
};

/// The photos as the network is given them, and where each lies in its input.
struct VggtInputs {
  std::vector<Image<uint8_t>> images;  ///< all of one size
  std::vector<nn::VggtPlacement> placements;
};
/// Landscape photos as its loader makes them (width 518); portraits, or both mixed, padded with
/// white to 518 x 518.
VggtInputs vggt_inputs(const std::vector<Photo>& photos, ThreadPool& pool);

/// Memory for running the network beside the photos, item by item.
void add_vggt_memory(MemoryBudget& budget, const nn::Weights& weights, nn::Precision precision,
                     size_t frames, int width, int height);

/// Error{kFailed} when a predicted camera is impossible (a field of view of 0 or of half a turn and
/// more, numbers that are not finite), naming the photo.
std::vector<VggtView> predict_vggt_views(nn::Compute& compute, const nn::Vggt& network,
                                         const std::vector<Photo>& photos, VggtInputs inputs,
                                         const VggtPredictionOptions& options);

/// The camera of a photo of width x height from the camera of the network's input.
Camera camera_of_photo(const nn::VggtCamera& predicted, const nn::VggtPlacement& placement,
                       int width, int height);

/// The part of the network's map that shows the photo, resampled to the photo's aspect; its longer
/// side is that of the part. Bilinear within a surface, the nearest value across a step of depth.
struct PhotoMaps {
  ImageF depth, confidence;
};
PhotoMaps maps_of_photo(const nn::FeatureMap& depth, const nn::VggtPlacement& placement, int width,
                        int height);

/// The value below which `percent` % of the positive values of all maps lie; 0 without any.
float confidence_at(const std::vector<VggtView>& views, double percent);

}  // namespace aligngs
