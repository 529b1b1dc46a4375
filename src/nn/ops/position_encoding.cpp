#include "nn/ops/position_encoding.h"

#include <algorithm>
#include <cmath>

namespace aligngs::nn {

FeatureMap uv_grid(int64_t height, int64_t width, double aspect) {
  FeatureMap grid(height, width, 2);
  const double diagonal = std::sqrt(aspect * aspect + 1);
  const auto place = [](double span, int64_t i, int64_t n) {
    const double end = span * double(n - 1) / double(n);
    return n > 1 ? -end + 2 * end * double(i) / double(n - 1) : 0.0;
  };
  for (int64_t y = 0; y < height; ++y) {
    for (int64_t x = 0; x < width; ++x) {
      grid.at(y, x)[0] = float(place(aspect / diagonal, x, width));
      grid.at(y, x)[1] = float(place(1 / diagonal, y, height));
    }
  }
  return grid;
}

FeatureMap uv_embedding(int64_t height, int64_t width, int64_t channels, double aspect) {
  const FeatureMap grid = uv_grid(height, width, aspect);
  const int64_t quarter = channels / 4;
  constexpr double kBase = 100;
  FeatureMap out(height, width, channels);
  const auto encode = [&](int64_t y, int64_t x, int64_t axis) {
    const double p = double(grid.at(y, x)[axis]);
    float* to = out.at(y, x) + axis * 2 * quarter;
    for (int64_t k = 0; k < quarter; ++k) {
      const double angle = p * std::pow(kBase, -double(k) / (double(channels) / 4));
      to[k] = float(std::sin(angle));
      to[quarter + k] = float(std::cos(angle));
    }
  };
  // x is the same in every row and y in every column.
  for (int64_t x = 0; x < width; ++x) encode(0, x, 0);
  for (int64_t y = 0; y < height; ++y) encode(y, 0, 1);
  for (int64_t y = 0; y < height; ++y) {
    for (int64_t x = 0; x < width; ++x) {
      for (int64_t c = 0; c < 2 * quarter; ++c) {
        out.at(y, x)[c] = out.at(0, x)[c];
        out.at(y, x)[2 * quarter + c] = out.at(y, 0)[2 * quarter + c];
      }
    }
  }
  return out;
}

FeatureMap sine_encoding(int64_t height, int64_t width, int64_t features) {
  constexpr double kTwoPi = 6.283185307179586, kTemperature = 10000, kEps = 1e-6;
  FeatureMap out(height, width, 2 * features);
  const auto encode = [&](float* to, double angle) {
    for (int64_t k = 0; k < features; ++k) {
      const double v = angle / std::pow(kTemperature, 2 * double(k / 2) / double(features));
      to[k] = float(k % 2 == 0 ? std::sin(v) : std::cos(v));
    }
  };
  // y is the same in every column and x in every row.
  for (int64_t y = 0; y < height; ++y) encode(out.at(y, 0), double(y + 1) / (double(height) + kEps) * kTwoPi);
  for (int64_t x = 0; x < width; ++x) encode(out.at(0, x) + features, double(x + 1) / (double(width) + kEps) * kTwoPi);
  for (int64_t y = 0; y < height; ++y) {
    for (int64_t x = 0; x < width; ++x) {
      if (x > 0) std::copy_n(out.at(y, 0), features, out.at(y, x));
      if (y > 0) std::copy_n(out.at(0, x) + features, features, out.at(y, x) + features);
    }
  }
  return out;
}

Matrix reference_points(int64_t height, int64_t width) {
  Matrix points(height * width, 2);
  for (int64_t i = 0; i < points.rows; ++i) {
    points.row(i)[0] = float((double(i % width) + 0.5) / double(width));
    points.row(i)[1] = float((double(i / width) + 0.5) / double(height));
  }
  return points;
}

}  // namespace aligngs::nn
