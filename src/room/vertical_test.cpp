#include "room/vertical.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace aligngs {
namespace {

ScenePlane facing(const Vec3d& normal, size_t points) {
  ScenePlane plane;
  plane.normal = normalized(normal);
  plane.points = points;
  return plane;
}

const Vec3d kTilted = normalized(Vec3d{0.3, 0, 1});

TEST(Vertical, IsThatOfTheFloor) {
  const Vec3d up = vertical_near(kTilted, {facing({0, 0, 1}, 500), facing({1, 0, 0}, 900), facing({0, 1, 0}, 800)});
  EXPECT_NEAR(up.z, 1, 1e-9);
}

TEST(Vertical, ACeilingCountsAsWell) {
  EXPECT_NEAR(vertical_near(kTilted, {facing({0, 0, -1}, 500), facing({1, 0, 0}, 900)}).z, 1, 1e-9);
}

TEST(Vertical, WallsDecideBetweenASlopeAndTheFloor) {
  const Vec3d slope{0.35, 0, 1};
  const Vec3d up = vertical_near(kTilted, {facing(slope, 600), facing({0, 0, 1}, 400), facing({1, 0, 0}, 900)});
  EXPECT_NEAR(up.z, 1, 1e-9);
}

TEST(Vertical, WithoutALevelPlaneTheRoughOneStays) {
  EXPECT_NEAR(norm(vertical_near(kTilted, {facing({1, 0, 0}, 900)}) - kTilted), 0, 1e-12);
  EXPECT_NEAR(norm(vertical_near(kTilted, {}) - kTilted), 0, 1e-12);
}

TEST(Vertical, PlanesThatAreNotFiniteAreLeftOut) {
  ScenePlane broken = facing({0, 0, 1}, 1000);
  broken.normal.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(vertical_near(kTilted, {broken, facing({0, 0, 1}, 10)}).z, 1, 1e-9);
}

}  // namespace
}  // namespace aligngs
