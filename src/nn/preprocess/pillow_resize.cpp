#include "nn/preprocess/pillow_resize.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace aligngs::nn {
namespace {

constexpr int kBits = 22;  // PRECISION_BITS of Pillow's Resample.c: 32 - 8 - 2

double cubic(double t) {
  constexpr double a = -0.5;
  t = std::abs(t);
  if (t < 1) return ((a + 2) * t - (a + 3)) * t * t + 1;
  if (t < 2) return (((t - 5) * t + 8) * t - 4) * a;
  return 0;
}

double triangle(double t) { return std::max(1 - std::abs(t), 0.0); }

struct Filter {
  double (*weight)(double);
  double reach;  ///< beyond it the weight is 0
};

struct FilterTaps {
  int first = 0;
  std::vector<int64_t> weights;
};

std::vector<FilterTaps> filter_taps_of(int inputs, int outputs, const Filter& filter) {
  const double scale = double(inputs) / outputs, widening = std::max(scale, 1.0);
  const double support = filter.reach * widening;
  std::vector<FilterTaps> all(static_cast<size_t>(outputs));
  for (int i = 0; i < outputs; ++i) {
    const double centre = (i + 0.5) * scale;
    const int low = std::max(int(centre - support + 0.5), 0);
    const int high = std::min(int(centre + support + 0.5), inputs);
    std::vector<double> weights;
    double total = 0;
    for (int k = low; k < high; ++k) {
      weights.push_back(filter.weight((k + 0.5 - centre) / widening));
      total += weights.back();
    }
    FilterTaps& taps = all[size_t(i)];
    taps.first = low;
    for (const double weight : weights) {
      const double fixed = weight / total * (1 << kBits);
      taps.weights.push_back(int64_t(fixed < 0 ? fixed - 0.5 : fixed + 0.5));
    }
  }
  return all;
}

/// Mixes values that lie `stride` apart.
uint8_t mix(const uint8_t* from, size_t stride, const FilterTaps& taps) {
  int64_t sum = int64_t(1) << (kBits - 1);
  for (size_t k = 0; k < taps.weights.size(); ++k) sum += taps.weights[k] * from[k * stride];
  return uint8_t(std::clamp<int64_t>(sum >> kBits, 0, 255));
}

Image<uint8_t> resized(const Image<uint8_t>& image, int width, int height, const Filter& filter) {
  if (width <= 0 || height <= 0 || image.empty())
    throw Error({ErrorKind::kFailed, "resizing to or from nothing", {}, "size", ""});
  Image<uint8_t> wide = image;
  const int channels = image.channels;
  if (width != image.width) {
    wide = Image<uint8_t>(width, image.height, channels);
    const std::vector<FilterTaps> taps = filter_taps_of(image.width, width, filter);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < channels; ++c) {
          wide.at(x, y, c) = mix(&image.at(taps[size_t(x)].first, y, c), size_t(channels), taps[size_t(x)]);
        }
      }
    }
  }
  if (height == image.height) return wide;
  Image<uint8_t> out(width, height, channels);
  const std::vector<FilterTaps> taps = filter_taps_of(image.height, height, filter);
  const size_t line = size_t(width) * size_t(channels);
  for (int y = 0; y < height; ++y) {
    const uint8_t* from = wide.pixel(0, taps[size_t(y)].first);
    uint8_t* to = out.pixel(0, y);
    for (size_t i = 0; i < line; ++i) to[i] = mix(from + i, line, taps[size_t(y)]);
  }
  return out;
}

}  // namespace

Image<uint8_t> pillow_resize_bicubic(const Image<uint8_t>& image, int width, int height) {
  return resized(image, width, height, {cubic, 2});
}

Image<uint8_t> pillow_resize_bilinear(const Image<uint8_t>& image, int width, int height) {
  return resized(image, width, height, {triangle, 1});
}

Image<uint8_t> pillow_rgb_on_white(const Image<uint8_t>& image) {
  Image<uint8_t> rgb(image.width, image.height, 3);
  for (size_t p = 0; p < image.pixels(); ++p) {
    const uint8_t* from = image.data.data() + p * size_t(image.channels);
    uint8_t* to = rgb.data.data() + p * 3;
    const bool grey = image.channels < 3;
    const bool has_alpha = image.channels == 2 || image.channels == 4;
    const uint32_t alpha = has_alpha ? from[image.channels - 1] : 255;
    for (int c = 0; c < 3; ++c) {
      const uint32_t value = from[grey ? 0 : c];
      if (!has_alpha) {
        to[c] = uint8_t(value);
        continue;
      }
      // AlphaComposite.c: 7 more bits of precision than 8; white and opaque is the lower image.
      constexpr uint32_t kWhite = 255, kPrecision = 7;
      const uint32_t blend = alpha * 255 + kWhite * (255 - alpha);
      const uint32_t upper = alpha * 255 * 255 * (1 << kPrecision) / blend;
      const uint32_t lower = 255 * (1 << kPrecision) - upper;
      const uint32_t sum = value * upper + kWhite * lower + (0x80 << kPrecision);
      to[c] = uint8_t((((sum >> 8) + sum) >> 8) >> kPrecision);
    }
  }
  return rgb;
}

}  // namespace aligngs::nn
