// A network's prediction for a photo, in the photo's own pixels: a camera, dense depth and its confidence.
#pragma once

#include <optional>
#include <vector>

#include "core/image.h"
#include "core/progress.h"
#include "nn/network_camera.h"
#include "nn/preprocess/image_placement.h"
#include "nn/tensor.h"
#include "priors/metres_estimate.h"
#include "priors/photo_folder.h"
#include "scene/camera.h"

namespace aligngs {

struct PredictedView {
  Camera camera;      ///< at the size of the photo; the first view's pose is the identity
  ImageF depth;       ///< scene units (arbitrary), aspect of the photo; 0: outside of the network's view
  ImageF confidence;  ///< 1 (none) upwards, same size; 0 where depth is
};

/// All photos by one network.
struct PredictedViews {
  std::vector<PredictedView> views;
  std::optional<MetresEstimate> metres;  ///< where depth and translations are in metres
};

struct ViewPredictionOptions {
  /// All views get the median focal length: for photos of one camera without zoom.
  bool shared_focal = false;
  ProgressStyle progress;
  bool camera_to_world = false;  ///< the network's poses are camera to world (LingBot-Map), not world to camera
  bool from_rays = false;        ///< Depth Anything 3: cameras from its rays, not from its camera decoder
};

/// A view of `photo` from the network's camera and its map [H, W, 2] of depth and confidence. Error{kFailed} names the
/// photo when the camera is impossible: numbers that are not finite, a field of view of nothing or of half a turn.
PredictedView view_of_photo(const Photo& photo, const nn::NetworkCamera& camera, const nn::FeatureMap& depth,
                            const nn::ImagePlacement& placement);
/// The first camera, which networks predict near the identity, becomes it; then shared_focal.
void finish_views(std::vector<PredictedView>& views, const ViewPredictionOptions& options);

/// The camera of a photo of width x height from the camera of the network's input.
Camera camera_of_photo(const nn::NetworkCamera& predicted, const nn::ImagePlacement& placement, int width, int height);

/// The part of the network's map that shows the photo, resampled to the photo's aspect; its longer
/// side is that of the part. Bilinear within a surface, the nearest value across a step of depth.
struct PhotoMaps {
  ImageF depth, confidence;
};
PhotoMaps maps_of_photo(const nn::FeatureMap& depth, const nn::ImagePlacement& placement, int width, int height);

/// Percent of the depth, that of the lowest confidence, that is left out where nobody says another number.
inline constexpr double kUnsureDepthPercent = 20;

/// The value below which `percent` % of the positive values of all maps lie; 0 without any.
float confidence_at(const std::vector<PredictedView>& views, double percent);

}  // namespace aligngs
