#include "nn/preprocess/opencv_resize.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace aligngs::nn {
namespace {

struct LinearTaps {
  int low, high;
  int low_weight, high_weight;  ///< of 2048
};

/// Along x the weight is dropped where the image ends; along y only the row index is held there.
std::vector<LinearTaps> linear_taps_of(int inputs, int outputs, bool horizontal) {
  constexpr float kOne = 2048;
  std::vector<LinearTaps> all;
  const double scale = double(inputs) / outputs;
  for (int i = 0; i < outputs; ++i) {
    const float position = float((i + 0.5) * scale - 0.5);
    int index = int(std::floor(position));
    float f = position - float(index);
    if (horizontal && index < 0) {
      f = 0;
      index = 0;
    }
    if (horizontal && index >= inputs - 1) {
      f = 0;
      index = inputs - 1;
    }
    // lrint: to nearest even, as saturate_cast rounds.
    all.push_back({std::clamp(index, 0, inputs - 1), std::clamp(index + 1, 0, inputs - 1),
                   int(std::lrint((1.0f - f) * kOne)), int(std::lrint(f * kOne))});
  }
  return all;
}

}  // namespace

Image<uint8_t> opencv_resize_linear(const Image<uint8_t>& image, int width, int height) {
  if (width <= 0 || height <= 0 || image.empty())
    throw Error({ErrorKind::kFailed, "resizing to or from nothing", {}, "size", ""});
  if (width == image.width && height == image.height) return image;
  const std::vector<LinearTaps> columns = linear_taps_of(image.width, width, true);
  const std::vector<LinearTaps> rows = linear_taps_of(image.height, height, false);
  const int channels = image.channels;
  Image<uint8_t> out(width, height, channels);
  const auto mixed = [&](int x, int y, int c) {
    const LinearTaps& taps = columns[size_t(x)];
    return int(image.at(taps.low, y, c)) * taps.low_weight + int(image.at(taps.high, y, c)) * taps.high_weight;
  };
  for (int y = 0; y < height; ++y) {
    const LinearTaps& taps = rows[size_t(y)];
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const int upper = (taps.low_weight * (mixed(x, taps.low, c) >> 4)) >> 16;
        const int lower = (taps.high_weight * (mixed(x, taps.high, c) >> 4)) >> 16;
        out.at(x, y, c) = uint8_t(std::clamp((upper + lower + 2) >> 2, 0, 255));
      }
    }
  }
  return out;
}

}  // namespace aligngs::nn
