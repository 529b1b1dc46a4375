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

UvAxes uv_axes(int64_t height, int64_t width, int64_t channels, double aspect) {
  const int64_t quarter = channels / 4;
  constexpr double kBase = 100;
  // x is the same in every row and y in every column.
  const FeatureMap xs = uv_grid(1, width, aspect), ys = uv_grid(height, 1, aspect);
  const auto encode = [&](float p, float* to) {
    for (int64_t k = 0; k < quarter; ++k) {
      const double angle = double(p) * std::pow(kBase, -double(k) / (double(channels) / 4));
      to[k] = float(std::sin(angle));
      to[quarter + k] = float(std::cos(angle));
    }
  };
  UvAxes axes{Matrix(width, 2 * quarter), Matrix(height, 2 * quarter)};
  for (int64_t x = 0; x < width; ++x) encode(xs.at(0, x)[0], axes.x.row(x));
  for (int64_t y = 0; y < height; ++y) encode(ys.at(y, 0)[1], axes.y.row(y));
  return axes;
}

FeatureMap uv_embedding(int64_t height, int64_t width, int64_t channels, double aspect) {
  const UvAxes axes = uv_axes(height, width, channels, aspect);
  const int64_t half = axes.x.columns;
  FeatureMap out(height, width, channels);
  for (int64_t y = 0; y < height; ++y) {
    for (int64_t x = 0; x < width; ++x) {
      std::copy_n(axes.x.row(x), half, out.at(y, x));
      std::copy_n(axes.y.row(y), half, out.at(y, x) + half);
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
