#include "synth/noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

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
  ImageF map(width, height, 1);
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    const double v = (y + 0.5) / height * rows;
    const int row = std::min(static_cast<int>(v), rows - 1);
    double wy[4], wx[4];
    cubic_weights(v - row, wy);
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width * columns;
      const int column = std::min(static_cast<int>(u), columns - 1);
      cubic_weights(u - column, wx);
      double value = 0;
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i) value += wy[j] * wx[i] * control[static_cast<size_t>(row + j) * nx + column + i];
      }
      map.at(x, y) = static_cast<float>(value);
      sum += value * value;
    }
  }
  const double current = std::sqrt(sum / std::max<size_t>(1, map.pixels()));
  const float factor = current > 0 ? static_cast<float>(rms / current) : 0.0f;
  for (float& value : map.data) value *= factor;
  return map;
}

}  // namespace aligngs
