// Depth Anything 3's networks of one photo (DA3METRIC-LARGE, DA3MONO-LARGE): depth and sky.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "nn/da3/heads.h"
#include "nn/da3/trunk.h"

namespace aligngs::nn {

struct Da3MetricOptions {
  int64_t heads = 0;        ///< 0: channels / 64
  std::vector<int> layers;  ///< empty: 4, 11, 17, 23 (of 24)
};

class Da3Metric {
 public:
  /// Names as published ("model.*"); a nested file's metric part ("model.da3_metric.*") as well. Error{kWeights} when
  /// tensors are missing or do not fit.
  Da3Metric(Compute& compute, const Weights& weights, const Da3MetricOptions& options = {});

  /// A normalised image whose sides are multiples of 14 -> [H, W, 2]: depth as the head gives it, and sky (about 0:
  /// ground, 1: sky). Metres are depth * focal / kDa3MetricFocal.
  FeatureMap operator()(Compute& compute, const FeatureMap& image) const;

  const Da3Trunk& trunk() const { return *trunk_; }
  const Da3SkyHead& head() const { return *head_; }

 private:
  std::optional<Da3SkyHead> head_;
  std::optional<Da3Trunk> trunk_;
};

/// Focal length, in pixels of the network's input, at which the metric network's depth is in metres.
inline constexpr double kDa3MetricFocal = 300;
/// Sky below this is ground.
inline constexpr float kDa3SkyThreshold = 0.3f;

/// The depth of sky becomes the 0.99 quantile of the ground's, over all maps [H, W, 2] together. Nothing changes with
/// ten pixels or fewer of either.
void fill_da3_sky(std::vector<FeatureMap>& maps);

}  // namespace aligngs::nn
