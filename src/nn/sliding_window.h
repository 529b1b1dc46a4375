// Dense prediction on images larger than the network was trained on: overlapping windows, averaged.
#pragma once

#include <functional>

#include "nn/compute.h"
#include "nn/tensor.h"

namespace aligngs::nn {

struct SlidingWindow {
  int64_t crop_height = 0, crop_width = 0;  ///< 0: the whole image at once
  int64_t stride_height = 0, stride_width = 0;
};

/// `predict` maps a part of the image to values of the same height and width. The last window of a
/// row or column ends with the image (mmseg's slide_inference).
FeatureMap slide(Compute& compute, const FeatureMap& image, const SlidingWindow& window,
                 const std::function<FeatureMap(const FeatureMap&)>& predict);

FeatureMap crop_map(const FeatureMap& map, int64_t top, int64_t left, int64_t height, int64_t width);
FeatureMap flip_horizontally(const FeatureMap& map);

}  // namespace aligngs::nn
