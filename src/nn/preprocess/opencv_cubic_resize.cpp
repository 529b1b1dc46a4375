#include "nn/preprocess/opencv_cubic_resize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace aligngs::nn {
namespace {

constexpr size_t kTaps = 4;
constexpr size_t kLanes = 8;  // values of a row that OpenCV mixes at a time, in floating point

struct CubicTaps {
  std::array<int, kTaps> index, weight;  ///< weights of 2048
};

std::vector<CubicTaps> cubic_taps_of(int inputs, int outputs) {
  constexpr float a = -0.75f, kOne = 2048;
  const double step = 1 / (double(outputs) / double(inputs));
  std::vector<CubicTaps> all;
  for (int i = 0; i < outputs; ++i) {
    const auto position = float((i + 0.5) * step - 0.5);
    const int base = int(std::floor(position));
    const float x = position - float(base), before = x + 1.0f, after = 1.0f - x;
    std::array<float, kTaps> w{};
    w[0] = ((a * before - 5 * a) * before + 8 * a) * before - 4 * a;
    w[1] = ((a + 2) * x - (a + 3)) * x * x + 1;
    w[2] = ((a + 2) * after - (a + 3)) * after * after + 1;
    w[3] = 1.0f - w[0] - w[1] - w[2];
    CubicTaps taps;
    for (size_t k = 0; k < kTaps; ++k) {
      taps.index[k] = std::clamp(base - 1 + int(k), 0, inputs - 1);
      taps.weight[k] = int(std::lrint(w[k] * kOne));
    }
    all.push_back(taps);
  }
  return all;
}

uint8_t clamped(long v) { return uint8_t(std::clamp(v, 0L, 255L)); }

}  // namespace

Image<uint8_t> opencv_resize_cubic(const Image<uint8_t>& image, int width, int height) {
  if (width <= 0 || height <= 0 || image.empty())
    throw Error({ErrorKind::kFailed, "resizing to or from nothing", {}, "size", ""});
  const std::vector<CubicTaps> columns = cubic_taps_of(image.width, width), rows = cubic_taps_of(image.height, height);
  const int channels = image.channels;
  const size_t line = size_t(width) * size_t(channels);
  std::vector<int> wide(line * size_t(image.height));  // mixed horizontally, times 2048
  for (int y = 0; y < image.height; ++y) {
    int* const to = wide.data() + size_t(y) * line;
    for (int x = 0; x < width; ++x) {
      const CubicTaps& taps = columns[size_t(x)];
      for (int c = 0; c < channels; ++c) {
        int sum = 0;
        for (size_t k = 0; k < kTaps; ++k) sum += int(image.at(taps.index[k], y, c)) * taps.weight[k];
        to[x * channels + c] = sum;
      }
    }
  }
  constexpr float kScale = 1.0f / 4194304.0f;  // of the two fixed points together, 2^-22
  constexpr int kHalf = 1 << 21, kBits = 22;
  Image<uint8_t> out(width, height, channels);
  for (int y = 0; y < height; ++y) {
    const CubicTaps& taps = rows[size_t(y)];
    std::array<const int*, kTaps> from{};
    std::array<float, kTaps> weight{};
    for (size_t k = 0; k < kTaps; ++k) {
      from[k] = wide.data() + size_t(taps.index[k]) * line;
      weight[k] = float(taps.weight[k]) * kScale;
    }
    uint8_t* const to = out.pixel(0, y);
    const size_t whole = line / kLanes * kLanes;
    for (size_t i = 0; i < whole; ++i) {
      float sum = float(from[3][i]) * weight[3];
      for (size_t k = 3; k-- > 0;) sum = float(from[k][i]) * weight[k] + sum;
      to[i] = clamped(std::lrint(sum));
    }
    for (size_t i = whole; i < line; ++i) {
      int64_t sum = kHalf;
      for (size_t k = 0; k < kTaps; ++k) sum += int64_t(from[k][i]) * taps.weight[k];
      to[i] = clamped(long(sum >> kBits));
    }
  }
  return out;
}

}  // namespace aligngs::nn
