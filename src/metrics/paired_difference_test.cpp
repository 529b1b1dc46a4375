#include "metrics/paired_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"

namespace aligngs {
namespace {

TEST(PairedDifference, ASteadyGainIsBeyondTheNoiseThoughScenesDiffer) {
  // Rooms differ by 5 dB, the gain is 0.5 dB in each: unpaired statistics would see nothing.
  const std::vector<double> a = {18, 20, 21, 23, 19, 22}, b = {18.4, 20.6, 21.5, 23.5, 19.5, 22.5};
  const PairedDifference d = paired_difference(a, b);
  EXPECT_EQ(d.pairs, 6u);
  EXPECT_NEAR(d.mean, 0.5, 1e-12);
  EXPECT_GT(d.low, 0.4);
  EXPECT_LT(d.high, 0.6);
  EXPECT_TRUE(d.beyond_noise());
}

TEST(PairedDifference, NoiseAloneIsNot) {
  const PairedDifference d = paired_difference({1, 2, 3, 4}, {1.3, 1.7, 3.2, 3.8});
  EXPECT_FALSE(d.beyond_noise());
  EXPECT_LE(d.low, d.mean);
  EXPECT_GE(d.high, d.mean);
}

TEST(PairedDifference, WidthIsThatOfTheNormalIntervalForManyPairs) {
  Random random(3);
  std::vector<double> a(400), b(400);
  for (size_t i = 0; i < a.size(); ++i) b[i] = a[i] + random.normal();
  const PairedDifference d = paired_difference(a, b);
  EXPECT_NEAR(d.high - d.low, 2 * 1.96 / std::sqrt(400.0), 0.02);
}

TEST(PairedDifference, PairsWithoutANumberAreLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const PairedDifference d = paired_difference({1, nan, 3}, {2, 5, nan});
  EXPECT_EQ(d.pairs, 1u);
  EXPECT_EQ(d.mean, 1);
  EXPECT_FALSE(d.beyond_noise()) << "one pair proves nothing";
}

TEST(PairedDifference, NoPairsAreNotANumber) {
  const PairedDifference d = paired_difference({}, {});
  EXPECT_EQ(d.pairs, 0u);
  EXPECT_TRUE(std::isnan(d.mean));
  EXPECT_FALSE(d.beyond_noise());
}

TEST(PairedDifference, FewPairsHaveAMeanAndNoInterval) {
  const PairedDifference d = paired_difference({1, 2}, {2, 4});
  EXPECT_DOUBLE_EQ(d.mean, 1.5);
  EXPECT_TRUE(std::isnan(d.low) && std::isnan(d.high));
  EXPECT_FALSE(d.has_interval() || d.beyond_noise());
}

TEST(PairedDifference, IsTheSameEveryTime) {
  const std::vector<double> a = {1, 2, 3, 4, 5}, b = {2, 1, 4, 6, 5};
  EXPECT_EQ(paired_difference(a, b).low, paired_difference(a, b).low);
}

}  // namespace
}  // namespace aligngs
