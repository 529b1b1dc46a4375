#include "room/level_planes.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

/// Points on a level square, seen from the middle of a room 2.5 m high.
void add_square(std::vector<SeenPoint>& points, double z, double size, double up) {
  for (double x = -size / 2; x <= size / 2; x += 0.1) {
    for (double y = -size / 2; y <= size / 2; y += 0.1) points.push_back({{0, 0, 1.5}, {x, y, z}, {0, 0, up}, 2});
  }
}

ScenePlane level_plane(double z, double up) {
  ScenePlane plane;
  plane.normal = {0, 0, up};
  plane.centre = {0, 0, z};
  plane.offset = -up * z;
  return plane;
}

TEST(LevelPlanes, FloorAndCeilingEndTheRoom) {
  std::vector<SeenPoint> points;
  add_square(points, 0, 3, 1);
  add_square(points, 0.75, 1.5, 1);
  add_square(points, 2.5, 3, -1);
  add_square(points, 2.1, 1, -1);
  const LevelPlanes found =
      find_level_planes({level_plane(0.75, 1), level_plane(0, 1), level_plane(2.1, -1), level_plane(2.5, -1)}, points);
  EXPECT_EQ(found.floor, 1u);
  EXPECT_EQ(found.ceilings, std::vector<size_t>{3});
  EXPECT_NEAR(found.high - found.low, 2.5, 1e-9);
}

TEST(LevelPlanes, ATableAboveAFloorThatIsNoPlaneIsNoFloor) {
  std::vector<SeenPoint> points;
  add_square(points, 0, 3, 1);
  add_square(points, 0.75, 1.5, 1);
  add_square(points, 2.5, 3, -1);
  EXPECT_FALSE(find_level_planes({level_plane(0.75, 1), level_plane(2.5, -1)}, points).floor);
}

TEST(LevelPlanes, AShelfAboveTheCamerasIsNoFloor) {
  std::vector<SeenPoint> points;
  add_square(points, 2, 3, 1);
  EXPECT_FALSE(find_level_planes({level_plane(2, 1)}, points).floor);
}

TEST(LevelPlanes, ASlopeAboveTheCamerasIsACeiling) {
  std::vector<SeenPoint> points;
  add_square(points, 0, 3, 1);
  ScenePlane slope;
  slope.normal = normalized(Vec3d{0, 1, -1});
  slope.centre = {0, 0, 2};
  slope.offset = -dot(slope.normal, slope.centre);
  for (double x = -1; x <= 1; x += 0.1) {
    for (double t = -0.6; t <= 0.6; t += 0.1) points.push_back({{0, 0, 1.5}, {x, t, 2 + t}, slope.normal, 2});
  }
  EXPECT_EQ(find_level_planes({level_plane(0, 1), slope}, points).ceilings, std::vector<size_t>{1});
}

TEST(LevelPlanes, NothingSeenIsNothing) {
  const LevelPlanes found = find_level_planes({level_plane(0, 1)}, {});
  EXPECT_FALSE(found.floor);
  EXPECT_EQ(found.high, found.low);
}

}  // namespace
}  // namespace aligngs
