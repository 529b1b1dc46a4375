#include "edit/fill/self_likeness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

constexpr int kColumns = 40, kRows = 30, kPeriod = 6;

/// Stripes along the rows; unknown in a corner.
TextureMap stripes() {
  TextureMap map{kColumns, kRows, {}, {}};
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const float s = static_cast<float>(std::sin(2 * 3.14159265 * i / kPeriod));
      map.value.push_back({s, 0.5f * s, 0});
      map.mask.push_back(i < 10 && j < 10 ? 0.f : 1.f);
    }
  }
  return map;
}

/// The definition, sum by sum: mean products over the known pairs.
double correlation(const TextureMap& map, int di, int dj) {
  double product = 0, first = 0, second = 0;
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.columns; ++i) {
      if (!map.knows(i, j) || !map.knows(i + di, j + dj)) continue;
      const double a = static_cast<double>(map.value[map.index(i, j)].x);
      const double b = static_cast<double>(map.value[map.index(i + di, j + dj)].x);
      product += a * b;
      first += a * a;
      second += b * b;
    }
  }
  return product / std::sqrt(first * second);
}

TEST(SelfLikeness, IsTheCorrelationOfKnownPairs) {
  const TextureMap map = stripes();
  const SelfLikeness likeness(map, 12, 50);
  for (const auto& [i, j] : {std::pair{1, 0}, {3, 2}, {-4, 5}, {6, 0}, {-12, 12}, {0, 7}})
    EXPECT_NEAR(likeness.at(i, j), correlation(map, i, j), 1e-3) << i << ", " << j;
}

TEST(SelfLikeness, AWholePeriodIsAlikeAndHalfOfOneIsTheOpposite) {
  const SelfLikeness likeness(stripes(), 12, 50);
  EXPECT_NEAR(likeness.at(kPeriod, 3), 1, 1e-3);
  EXPECT_NEAR(likeness.at(-kPeriod, -3), 1, 1e-3);
  EXPECT_NEAR(likeness.at(kPeriod / 2, 0), -1, 1e-3);
}

TEST(SelfLikeness, FewPairsTellNothing) {
  EXPECT_EQ(SelfLikeness(stripes(), 35, 400).at(35, 0), 0);
  EXPECT_EQ(SelfLikeness(stripes(), 12, 50).at(13, 0), 0) << "beyond the reach";
}

TEST(SelfLikeness, OneColourIsNotAlike) {
  TextureMap map = stripes();
  for (Vec3f& value : map.value) value = {0, 0, 0};
  EXPECT_EQ(SelfLikeness(map, 12, 50).at(3, 3), 0);
}

}  // namespace
}  // namespace aligngs
