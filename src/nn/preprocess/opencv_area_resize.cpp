#include "nn/preprocess/opencv_area_resize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"

namespace aligngs::nn {
namespace {

struct AreaTap {
  int index;
  float weight;
};

double step_of(int inputs, int outputs) { return 1 / (double(outputs) / double(inputs)); }

uint8_t rounded(float v) { return uint8_t(std::clamp(std::lrint(v), 0L, 255L)); }  // to nearest even

/// Inputs that each output covers, with the shares of the first and the last.
std::vector<std::vector<AreaTap>> area_taps_of(int inputs, int outputs) {
  constexpr double kLeastShare = 1e-3;
  const double step = step_of(inputs, outputs);
  std::vector<std::vector<AreaTap>> all;
  for (int i = 0; i < outputs; ++i) {
    const double from = i * step, to = from + step, cell = std::min(step, double(inputs) - from);
    const int last = std::min(int(std::floor(to)), inputs - 1), first = std::min(int(std::ceil(from)), last);
    std::vector<AreaTap> taps;
    if (first - from > kLeastShare) taps.push_back({first - 1, float((first - from) / cell)});
    for (int k = first; k < last; ++k) taps.push_back({k, float(1.0 / cell)});
    if (to - last > kLeastShare) taps.push_back({last, float(std::min(std::min(to - last, 1.0), cell) / cell)});
    all.push_back(std::move(taps));
  }
  return all;
}

/// Both sides shrink by whole numbers: sums of integers.
Image<uint8_t> mean_of_cells(const Image<uint8_t>& image, int width, int height) {
  const int across = image.width / width, down = image.height / height;
  const auto share = float(1.0 / (across * down));
  Image<uint8_t> out(width, height, image.channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        int sum = 0;
        for (int v = 0; v < down; ++v) {
          for (int u = 0; u < across; ++u) sum += image.at(x * across + u, y * down + v, c);
        }
        out.at(x, y, c) = across == 2 && down == 2 ? uint8_t((sum + 2) >> 2) : rounded(float(sum) * share);
      }
    }
  }
  return out;
}

}  // namespace

Image<uint8_t> opencv_resize_area(const Image<uint8_t>& image, int width, int height) {
  if (width <= 0 || height <= 0 || width > image.width || height > image.height)
    throw Error({ErrorKind::kFailed, "an area resize can only shrink", {}, "size", ""});
  const auto is_whole = [](double step) {
    return std::abs(step - double(std::lrint(step))) < std::numeric_limits<double>::epsilon();
  };
  if (is_whole(step_of(image.width, width)) && is_whole(step_of(image.height, height)))
    return mean_of_cells(image, width, height);
  const std::vector<std::vector<AreaTap>> columns = area_taps_of(image.width, width),
                                          rows = area_taps_of(image.height, height);
  const int channels = image.channels;
  const size_t line = size_t(width) * size_t(channels);
  // A row mixed horizontally; those of two outputs overlap by one input at most.
  const auto mix_row = [&](int y, std::vector<float>& mixed) {
    std::fill(mixed.begin(), mixed.end(), 0.0f);
    for (int x = 0; x < width; ++x) {
      for (const AreaTap& tap : columns[size_t(x)]) {
        for (int c = 0; c < channels; ++c)
          mixed[size_t(x * channels + c)] += float(image.at(tap.index, y, c)) * tap.weight;
      }
    }
  };
  Image<uint8_t> out(width, height, channels);
  std::vector<float> mixed(line), sum(line);
  int held = -1;
  for (int y = 0; y < height; ++y) {
    std::fill(sum.begin(), sum.end(), 0.0f);
    for (const AreaTap& tap : rows[size_t(y)]) {
      if (tap.index != held) mix_row(held = tap.index, mixed);
      for (size_t i = 0; i < line; ++i) sum[i] += mixed[i] * tap.weight;
    }
    uint8_t* const to = out.pixel(0, y);
    for (size_t i = 0; i < line; ++i) to[i] = rounded(sum[i]);
  }
  return out;
}

}  // namespace aligngs::nn
