// Metres for the any-view networks of Depth Anything 3: their depth against the metric network's (the published
// "nested" recipe).
#pragma once

#include <cstddef>
#include <vector>

#include "nn/da3/da3.h"

namespace aligngs::nn {

struct MetricScale {
  double scale = 1;   ///< metres per unit of the any-view network, by least squares
  size_t pixels = 0;  ///< that decided
};

/// `metric`: maps [H, W, 2] of the same images, their sky filled, depth not yet times the focal length. Ground pixels
/// whose confidence is at least the median of the ground's decide. Error{kBadInput} with ten ground pixels or fewer,
/// or when none decides.
MetricScale da3_metric_scale(const std::vector<Da3Frame>& frames, const std::vector<FeatureMap>& metric);

/// Depth and translations times the scale; sky gets the 0.99 quantile of the ground's depth, at most 200 m, and a
/// confidence of 1. As above.
MetricScale make_da3_metric(std::vector<Da3Frame>& frames, const std::vector<FeatureMap>& metric);

/// Linear between the neighbours in order; 0 <= q <= 1, at least one value.
double quantile_of(std::vector<float> values, double q);

}  // namespace aligngs::nn
