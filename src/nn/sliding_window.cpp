#include "nn/sliding_window.h"

#include <algorithm>

#include "core/error.h"

namespace aligngs::nn {
namespace {

/// First positions of the windows along one side.
std::vector<int64_t> starts(int64_t length, int64_t crop, int64_t stride) {
  std::vector<int64_t> out;
  const int64_t count = std::max<int64_t>(length - crop + stride - 1, 0) / stride + 1;
  for (int64_t i = 0; i < count; ++i) out.push_back(std::max<int64_t>(std::min(i * stride + crop, length) - crop, 0));
  return out;
}

}  // namespace

FeatureMap crop_map(const FeatureMap& map, int64_t top, int64_t left, int64_t height, int64_t width) {
  FeatureMap out(height, width, map.channels);
  for (int64_t y = 0; y < height; ++y) std::copy_n(map.at(top + y, left), width * map.channels, out.at(y, 0));
  return out;
}

FeatureMap flip_horizontally(const FeatureMap& map) {
  FeatureMap out(map.height, map.width, map.channels);
  for (int64_t y = 0; y < map.height; ++y) {
    for (int64_t x = 0; x < map.width; ++x) std::copy_n(map.at(y, map.width - 1 - x), map.channels, out.at(y, x));
  }
  return out;
}

FeatureMap slide(Compute& compute, const FeatureMap& image, const SlidingWindow& window,
                 const std::function<FeatureMap(const FeatureMap&)>& predict) {
  if (window.crop_height <= 0 || window.crop_width <= 0) return predict(image);
  if (window.stride_height <= 0 || window.stride_width <= 0)
    throw_usage("a sliding window needs a stride", "set it to about two thirds of the window");
  const int64_t height = std::min(window.crop_height, image.height);
  const int64_t width = std::min(window.crop_width, image.width);
  const std::vector<int64_t> tops = starts(image.height, window.crop_height, window.stride_height);
  const std::vector<int64_t> lefts = starts(image.width, window.crop_width, window.stride_width);
  if (tops.size() == 1 && lefts.size() == 1) return predict(image);
  FeatureMap sum;
  std::vector<float> hits(size_t(image.places()), 0.0f);
  for (const int64_t top : tops) {
    for (const int64_t left : lefts) {
      const FeatureMap part = predict(crop_map(image, top, left, height, width));
      if (sum.data.empty()) sum = FeatureMap(image.height, image.width, part.channels);
      compute.for_rows(height, 1, [&](int64_t y, int64_t, Scratch&) {
        float* to = sum.at(top + y, left);
        const float* from = part.at(y, 0);
        for (int64_t i = 0; i < width * part.channels; ++i) to[i] += from[i];
        for (int64_t x = 0; x < width; ++x) hits[size_t((top + y) * image.width + left + x)] += 1;
      });
    }
  }
  compute.for_rows(sum.height, 1, [&](int64_t y, int64_t, Scratch&) {
    for (int64_t x = 0; x < sum.width; ++x) {
      float* values = sum.at(y, x);
      const float of = hits[size_t(y * sum.width + x)];
      if (of == 1) continue;
      for (int64_t c = 0; c < sum.channels; ++c) values[c] /= of;
    }
  });
  return sum;
}

}  // namespace aligngs::nn
