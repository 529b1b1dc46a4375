#include "edit/fill/blurred_cells.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

TEST(BlurredCells, APointBecomesAboutAGaussian) {
  constexpr int kSide = 61;
  std::vector<float> values(kSide * kSide, 0.f);
  values[30 * kSide + 30] = 1;
  blur_cells(values, kSide, kSide, 4);
  double sum = 0, squares = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double v = static_cast<double>(values[static_cast<size_t>(j * kSide + i)]);
      sum += v;
      squares += v * (i - 30) * (i - 30);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-4);
  EXPECT_NEAR(std::sqrt(squares / sum), 4, 0.6);
}

TEST(BlurredCells, AGridThatIsSmallerThanTheBlurStaysFinite) {
  std::vector<float> values{1, 2, 3};
  blur_cells(values, 3, 1, 50);
  for (const float v : values) EXPECT_TRUE(std::isfinite(v));
}

}  // namespace
}  // namespace aligngs
