#include "synth/outside.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

double distance_of(const Vec3d& origin, const Vec3d& direction) {
  double distance = 0;
  outside_color(origin, direction, {}, 3, &distance);
  return distance;
}

TEST(Outside, TheLawnLiesOneStoreyDown) {
  // Steeply down, before the nearest bushes: 1.5 m above the floor, 3 m above the lawn.
  EXPECT_NEAR(distance_of({0, 0, 1.5}, {0.1, 0, -1}), 4.5 * std::hypot(0.1, 1), 1e-9);
}

TEST(Outside, TheSkyIsInfinitelyFar) { EXPECT_TRUE(std::isinf(distance_of({1, 0, 1.5}, {0.2, 0.1, 1}))); }

TEST(Outside, ThingsStandAtThreeDistances) {
  const OutsideSettings s;
  int near = 0, middle = 0, far = 0;
  for (int i = 0; i < 2000; ++i) {
    const double a = i * 0.00314159, d = distance_of({0, 0, 1.5}, {std::cos(a), std::sin(a), 0.0});
    near += std::fabs(d - s.near_radius) < 1e-6;
    middle += std::fabs(d - s.middle_radius) < 1e-6;
    far += std::fabs(d - s.far_radius) < 1e-6;
  }
  EXPECT_GT(near, 100);
  EXPECT_GT(middle, 50);
  EXPECT_GT(far, 20);
}

TEST(Outside, AColourBelongsToAPlaceAndNotToARay) {
  // Two eyes see the same spot of the nearest things: the same colour.
  const OutsideSettings s;
  int compared = 0;
  for (int i = 0; i < 200; ++i) {
    const double a = i * 0.0314159;
    const Vec3d spot{s.near_radius * std::cos(a), s.near_radius * std::sin(a), 1.0}, left{0.5, 0.3, 1.4},
        right{-1, 0, 1.6};
    if (std::fabs(distance_of(left, spot - left) - norm(spot - left)) > 1e-6) continue;
    ++compared;
    EXPECT_NEAR(distance_of(right, spot - right), norm(spot - right), 1e-6);
    const Vec3f c = outside_color(left, spot - left, s, 3), d = outside_color(right, spot - right, s, 3);
    EXPECT_NEAR(norm(c - d), 0, 1e-3) << i;
  }
  EXPECT_GT(compared, 20);
}

TEST(Outside, ColoursAreAlbedos) {
  for (int i = 0; i < 500; ++i) {
    const Vec3f c = outside_color({0, 0, 1}, {std::cos(i * 0.1), std::sin(i * 0.1), i * 0.002 - 0.5}, {}, 9);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(c[k], 0) << i;
      EXPECT_LE(c[k], 1) << i;
    }
  }
}

}  // namespace
}  // namespace aligngs
