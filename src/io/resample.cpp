#include "io/resample.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"

namespace aligngs {
namespace {

/// The source samples that one target sample is a weighted mean of: first, first + 1, ...
struct Taps {
  int first = 0;
  std::vector<float> weights;
};

template <class T>
void require_size(const Image<T>& image, int width, int height) {
  if (image.width <= 0 || image.height <= 0 || width <= 0 || height <= 0) {
    throw Error({ErrorKind::kFailed,
                 "cannot resize " + std::to_string(image.width) + "x" + std::to_string(image.height) + " to " +
                     std::to_string(width) + "x" + std::to_string(height),
                 {},
                 "",
                 ""});
  }
}

std::vector<Taps> bilinear_taps(int source, int target) {
  std::vector<Taps> taps(static_cast<size_t>(target));
  for (int i = 0; i < target; ++i) {
    const double position = std::clamp((i + 0.5) * source / target - 0.5, 0.0, double(source - 1));
    const int first = std::min(int(position), std::max(source - 2, 0));
    const float second = float(position - first);
    taps[size_t(i)] = {first, source > 1 ? std::vector<float>{1 - second, second} : std::vector<float>{1}};
  }
  return taps;
}

/// Target sample i covers [i, i + 1) * source / target; each source sample counts by the length
/// covered.
std::vector<Taps> box_taps(int source, int target) {
  std::vector<Taps> taps(static_cast<size_t>(target));
  const double scale = double(source) / target;
  for (int i = 0; i < target; ++i) {
    const double begin = i * scale, end = std::min((i + 1) * scale, double(source));
    Taps& tap = taps[size_t(i)];
    tap.first = std::min(int(begin), source - 1);
    const int last = std::clamp(int(std::ceil(end)) - 1, tap.first, source - 1);
    double sum = 0;
    std::vector<double> lengths;
    for (int k = tap.first; k <= last; ++k) {
      lengths.push_back(std::max(0.0, std::min(end, k + 1.0) - std::max(begin, double(k))));
      sum += lengths.back();
    }
    for (const double length : lengths) tap.weights.push_back(float(length / sum));
  }
  return taps;
}

float value_of(float v) { return v; }
float value_of(uint8_t v) { return float(v) / 255.0f; }

/// A source row brought to the width of the target.
template <class T>
void narrow_row(const Image<T>& image, int y, const std::vector<Taps>& columns, std::vector<float>& row) {
  const int channels = image.channels;
  std::fill(row.begin(), row.end(), 0.f);
  for (size_t x = 0; x < columns.size(); ++x) {
    float* out = row.data() + x * size_t(channels);
    const Taps& tap = columns[x];
    for (size_t k = 0; k < tap.weights.size(); ++k) {
      const T* in = image.pixel(tap.first + int(k), y);
      for (int c = 0; c < channels; ++c) out[c] += tap.weights[k] * value_of(in[c]);
    }
  }
}

/// Only two rows of the source are held at the width of the target: one target row and the next share no more.
template <class T>
ImageF apply(const Image<T>& image, const std::vector<Taps>& columns, const std::vector<Taps>& rows) {
  const int width = int(columns.size()), height = int(rows.size());
  ImageF out(width, height, image.channels);
  const size_t row_values = size_t(width) * size_t(image.channels);
  std::vector<float> narrow[2] = {std::vector<float>(row_values), std::vector<float>(row_values)};
  int held[2] = {-1, -1};
  for (int y = 0; y < height; ++y) {
    float* to = out.data.data() + size_t(y) * row_values;
    const Taps& tap = rows[size_t(y)];
    for (size_t k = 0; k < tap.weights.size(); ++k) {
      const int source = tap.first + int(k), place = source & 1;
      if (held[place] != source) narrow_row(image, source, columns, narrow[place]);
      held[place] = source;
      for (size_t i = 0; i < row_values; ++i) to[i] += tap.weights[k] * narrow[place][i];
    }
  }
  return out;
}

template <class T>
ImageF area(const Image<T>& image, int width, int height) {
  const auto taps = [](int source, int target) {
    return target < source ? box_taps(source, target) : bilinear_taps(source, target);
  };
  return apply(image, taps(image.width, width), taps(image.height, height));
}

}  // namespace

ImageF resize_bilinear(const ImageF& image, int width, int height) {
  require_size(image, width, height);
  if (image.width == width && image.height == height) return image;
  return apply(image, bilinear_taps(image.width, width), bilinear_taps(image.height, height));
}

ImageF resize_area(const ImageF& image, int width, int height) {
  require_size(image, width, height);
  if (image.width == width && image.height == height) return image;
  return area(image, width, height);
}

ImageF resize_area(const Image<uint8_t>& image, int width, int height) {
  require_size(image, width, height);
  return area(image, width, height);
}

ImageF resize_depth(const ImageF& depth, int width, int height, float jump) {
  require_size(depth, width, height);
  if (depth.channels != 1) throw Error({ErrorKind::kFailed, "a depth map has one channel", {}, "", ""});
  const std::vector<Taps> columns = bilinear_taps(depth.width, width), rows = bilinear_taps(depth.height, height);
  ImageF out(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Taps &across = columns[size_t(x)], &down = rows[size_t(y)];
      float values[4], weights[4];
      int count = 0, nearest = -1;
      for (size_t j = 0; j < down.weights.size(); ++j) {
        for (size_t i = 0; i < across.weights.size(); ++i) {
          const float value = depth.at(across.first + int(i), down.first + int(j));
          const float weight = across.weights[i] * down.weights[j];
          if (!(weight > 0) || !(value > 0) || !std::isfinite(value)) continue;
          // The nearest sample has the largest weight; of equally near ones the nearer surface
          // counts.
          if (nearest < 0 || weight > weights[nearest] || (weight == weights[nearest] && value < values[nearest])) {
            nearest = count;
          }
          values[count] = value;
          weights[count++] = weight;
        }
      }
      if (nearest < 0) continue;
      double sum = 0, total = 0;
      for (int k = 0; k < count; ++k) {
        if (std::abs(values[k] - values[nearest]) > jump * values[nearest]) continue;
        sum += double(weights[k]) * values[k];
        total += weights[k];
      }
      out.at(x, y) = float(sum / total);
    }
  }
  return out;
}

}  // namespace aligngs
