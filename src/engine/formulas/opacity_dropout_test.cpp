#include "engine/formulas/opacity_dropout.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

TEST(OpacityDropout, OfRateZeroLeavesEverythingAsItIs) {
  const OpacityDropout none{0, 7};
  EXPECT_EQ(none.factor(), 1.0f);
  for (size_t row = 0; row < 1000; ++row) EXPECT_FALSE(none.drops(row));
}

TEST(OpacityDropout, DropsItsShareAndMakesUpForIt) {
  const OpacityDropout fifth{0.2f, 7};
  const size_t rows = 20000;
  size_t dropped = 0;
  for (size_t row = 0; row < rows; ++row) dropped += fifth.drops(row) ? 1 : 0;
  const double share = double(dropped) / double(rows), deviation = std::sqrt(0.2 * 0.8 / double(rows));
  EXPECT_NEAR(share, 0.2, 4 * deviation);
  EXPECT_NEAR((1 - share) * fifth.factor(), 1, 5 * deviation);
}

TEST(OpacityDropout, AnotherSeedDropsOthers) {
  const OpacityDropout one{0.5f, 1}, other{0.5f, 2};
  size_t alike = 0;
  for (size_t row = 0; row < 1000; ++row) alike += one.drops(row) == other.drops(row) ? 1 : 0;
  EXPECT_NEAR(alike, 500, 70);
}

}  // namespace
}  // namespace aligngs
