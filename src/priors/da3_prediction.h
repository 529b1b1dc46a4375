// Depth Anything 3 on photos: a camera, dense depth and its confidence for each, in the photos' own pixels.
#pragma once

#include <optional>
#include <vector>

#include "core/memory_budget.h"
#include "nn/compute.h"
#include "nn/da3/da3.h"
#include "nn/da3/metric.h"
#include "priors/metres_estimate.h"
#include "priors/predicted_view.h"

namespace aligngs {

/// The photos as the network is given them, and where each lies in its input.
struct Da3Inputs {
  std::vector<Image<uint8_t>> images;  ///< all of one size
  std::vector<nn::ImagePlacement> placements;
  /// [H, W, 2] of each by the metric network, see add_metric_depth(); may be empty
  std::vector<nn::FeatureMap> metric;
};
/// Longest side 504, as its program prepares them. Photos of several shapes are cut to what all have, in the middle.
Da3Inputs da3_inputs(const std::vector<Photo>& photos, ThreadPool& pool);

/// Memory that the network will need beside the photos, item by item. Reads shapes only.
void add_da3_memory(MemoryBudget& budget, const nn::Weights& weights, nn::Precision precision, size_t frames, int width,
                    int height);

/// The same for DA3METRIC on one photo at a time, beside the maps of all.
void add_da3_metric_memory(MemoryBudget& budget, const nn::Weights& weights, nn::Precision precision, size_t frames,
                           int width, int height);

/// Fills inputs.metric, sky included.
void add_metric_depth(nn::Compute& compute, const nn::Da3Metric& network, Da3Inputs& inputs,
                      const ProgressStyle& style);

/// Depth and translations are in units of the network, which are arbitrary, unless inputs.metric tells the metres. Then
/// sky has no depth. Error{kFailed} when a predicted camera is impossible, naming the photo.
PredictedViews predict_da3_views(nn::Compute& compute, const nn::Da3& network, const std::vector<Photo>& photos,
                                 Da3Inputs inputs, const ViewPredictionOptions& options);

/// Depth for views whose cameras are known (at the size of the photos). The network reads the cameras. Its depth is
/// scaled to their units by least squares over the centres. The cameras stay as they are. Error{kFailed} when the
/// network's own cameras do not fit the given ones at all.
std::vector<PredictedView> da3_depth_of_cameras(nn::Compute& compute, const nn::Da3& network,
                                                const std::vector<Photo>& photos, const std::vector<Camera>& cameras,
                                                Da3Inputs inputs, const ProgressStyle& style);

}  // namespace aligngs
