#include "synth/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace aligngs {
namespace {

/// A uniform cubic B-spline through the same random numbers, a pixel at a time.
ImageF simple_map(int width, int height, int columns, int rows, double rms, Random& random) {
  const auto weights = [](double t) {
    return std::vector<double>{(1 - t) * (1 - t) * (1 - t) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                               (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
  };
  std::vector<double> control(static_cast<size_t>((columns + 3) * (rows + 3)));
  for (double& value : control) value = random.normal();
  ImageF map(width, height, 1);
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width * columns, v = (y + 0.5) / height * rows;
      const int column = std::min(static_cast<int>(u), columns - 1), row = std::min(static_cast<int>(v), rows - 1);
      const std::vector<double> wx = weights(u - column), wy = weights(v - row);
      double value = 0;
      for (size_t j = 0; j < 4; ++j) {
        for (size_t i = 0; i < 4; ++i)
          value += wy[j] * wx[i] * control[(static_cast<size_t>(row) + j) * (columns + 3) + column + i];
      }
      map.at(x, y) = static_cast<float>(value);
      sum += value * value;
    }
  }
  const auto factor = static_cast<float>(rms / std::sqrt(sum / static_cast<double>(map.pixels())));
  for (float& value : map.data) value *= factor;
  return map;
}

TEST(SmoothRandomMap, HasTheBitsOfTheSimpleOne) {
  for (const auto& [width, height, columns, rows] : {std::array{64, 48, 4, 3}, {61, 7, 8, 6}, {5, 9, 7, 1}}) {
    Random a(3), b(3);
    EXPECT_EQ(smooth_random_map(width, height, columns, rows, 0.2, a).data,
              simple_map(width, height, columns, rows, 0.2, b).data);
    EXPECT_EQ(a.next(), b.next());
  }
}

}  // namespace
}  // namespace aligngs
