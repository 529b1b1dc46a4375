// Metres for cameras and depth of arbitrary units: what a network of one photo says of each photo, and one scale for
// the room.
//
// The scale is an estimate. Photos that disagree widen its spread, and up to half of them may be wrong.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "nn/da3/da3.h"
#include "nn/tensor.h"

namespace aligngs {

struct MetresEstimate {
  double scale = 1;   ///< metres per unit of the cameras, > 0
  double spread = 0;  ///< of the photos' own scales about it: standard deviation of the logarithm (from the median)
  size_t photos = 0;  ///< that had a scale of their own
};

/// The logarithm of one photo's metres per unit, robustly over its pixels. Pixels are ground of which the any-view
/// network is at least as sure as of half of the ground. `frame`: as predicted. `metric`: [H, W, 2] of the same image,
/// depth not yet times the focal length, and sky. Nothing when too few pixels tell, or when the sizes differ.
std::optional<double> log_metres_of_photo(const nn::Da3Frame& frame, const nn::FeatureMap& metric);

/// One scale from those of the photos: their median. Nothing without any.
std::optional<MetresEstimate> metres_estimate(std::vector<double> log_metres);

}  // namespace aligngs
