#include "synth/noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/target_clones.h"

namespace aligngs {

uint32_t lattice_hash(int32_t x, int32_t y, int32_t z, uint32_t seed) {
  uint32_t h = seed;
  for (const int32_t value : {x, y, z}) {
    h = (h ^ static_cast<uint32_t>(value)) * 747796405u + 2891336453u;
    h = ((h >> ((h >> 28) + 4)) ^ h) * 277803737u;
    h ^= h >> 22;
  }
  return h;
}

float lattice_random(int32_t x, int32_t y, int32_t z, uint32_t seed) {
  return static_cast<float>(lattice_hash(x, y, z, seed) >> 8) * (1.0f / 16777216.0f);
}

namespace {
float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

/// Weights of the four control points around a position t in [0, 1) of a uniform cubic B-spline.
void cubic_weights(double t, double w[4]) {
  w[0] = (1 - t) * (1 - t) * (1 - t) / 6;
  w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
  w[2] = (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6;
  w[3] = t * t * t / 6;
}

/// Pixels side by side that have the same control points.
struct SplineColumn {
  int column;                      ///< of the first control point
  int first;                       ///< pixel
  std::vector<double> weights[4];  ///< of the control points, per pixel
};

/// `control`: the first of four rows of four points, `stride` apart.
ALIGNGS_TARGET_CLONES
void evaluate_spline(const double* row_weights, const SplineColumn& spline, const double* control, int stride,
                     double* values) {
  const size_t count = spline.weights[0].size();
  std::fill_n(values, count, 0.0);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const double row_weight = row_weights[j], point = control[j * stride + i];
      const double* const weights = spline.weights[i].data();
      for (size_t x = 0; x < count; ++x) values[x] += row_weight * weights[x] * point;
    }
  }
}
}  // namespace

float value_noise(float x, float y, uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const float tx = fade(x - fx), ty = fade(y - fy);
  const float a = lattice_random(ix, iy, 0, seed), b = lattice_random(ix + 1, iy, 0, seed);
  const float c = lattice_random(ix, iy + 1, 0, seed), d = lattice_random(ix + 1, iy + 1, 0, seed);
  const float top = a + (b - a) * tx, bottom = c + (d - c) * tx;
  return 2 * (top + (bottom - top) * ty) - 1;
}

float fractal_noise(float x, float y, int octaves, uint32_t seed) {
  float sum = 0, amplitude = 0.5f;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * value_noise(x, y, seed + static_cast<uint32_t>(i) * 101u);
    x *= 2.03f;
    y *= 2.03f;
    amplitude *= 0.5f;
  }
  return sum;
}

ImageF smooth_random_map(int width, int height, int columns, int rows, double rms, Random& random) {
  // One extra ring of control points, so that the spline is defined up to the border.
  const int nx = columns + 3, ny = rows + 3;
  std::vector<double> control(static_cast<size_t>(nx) * ny);
  for (double& value : control) value = random.normal();
  std::vector<SplineColumn> splines;  // the same in every row
  for (int x = 0; x < width; ++x) {
    const double u = (x + 0.5) / width * columns;
    const int column = std::min(static_cast<int>(u), columns - 1);
    if (splines.empty() || splines.back().column != column) splines.push_back({column, x, {}});
    double w[4];
    cubic_weights(u - column, w);
    for (int i = 0; i < 4; ++i) splines.back().weights[i].push_back(w[i]);
  }
  ImageF map(width, height, 1);
  std::vector<double> values(static_cast<size_t>(width));
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    const double v = (y + 0.5) / height * rows;
    const int row = std::min(static_cast<int>(v), rows - 1);
    double wy[4];
    cubic_weights(v - row, wy);
    for (const SplineColumn& spline : splines)
      evaluate_spline(wy, spline, &control[static_cast<size_t>(row) * nx + spline.column], nx, &values[spline.first]);
    for (int x = 0; x < width; ++x) {
      map.at(x, y) = static_cast<float>(values[static_cast<size_t>(x)]);
      sum += values[static_cast<size_t>(x)] * values[static_cast<size_t>(x)];
    }
  }
  const double current = std::sqrt(sum / std::max<size_t>(1, map.pixels()));
  const float factor = current > 0 ? static_cast<float>(rms / current) : 0.0f;
  for (float& value : map.data) value *= factor;
  return map;
}

}  // namespace aligngs
