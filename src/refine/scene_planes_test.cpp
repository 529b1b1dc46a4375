#include "refine/scene_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"

namespace aligngs {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

/// Points on a plane through `origin` spanned by two unit vectors, seen by `views` photos in turn, with relative noise.
void add_patch(std::vector<PlanePoint>& points, PlaneKind kind, const Vec3d& origin, const Vec3d& u, const Vec3d& v,
               int count, int views, double noise, uint64_t seed) {
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    PlanePoint p;
    p.normal = cross(u, v);
    p.depth = 2.5;
    p.position =
        origin + u * random.uniform(0, 3) + v * random.uniform(0, 2.4) + p.normal * (noise * p.depth * random.normal());
    p.view = i % views;
    p.kind = kind;
    points.push_back(p);
  }
}

/// A corner of a room: two walls and a floor.
std::vector<PlanePoint> corner(double noise) {
  std::vector<PlanePoint> points;
  add_patch(points, PlaneKind::kWall, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1500, 5, noise, 1);
  add_patch(points, PlaneKind::kWall, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1000, 5, noise, 2);
  add_patch(points, PlaneKind::kFloor, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1200, 5, noise, 3);
  return points;
}

double angle(const Vec3d& a, const Vec3d& b) { return std::acos(std::min(1.0, dot(a, b))) / kDegree; }

/// A bare wall at z = 0 that networks alone have depth of, 0.3 % too far, and a door 2 cm before it, which stereo
/// measures exactly.
std::vector<PlanePoint> wall_with_door(bool named) {
  std::vector<PlanePoint> points;
  add_patch(points, PlaneKind::kWall, {0, 0, -0.0075}, {1, 0, 0}, {0, 1, 0}, 1500, 5, 0.01, 1);
  const size_t bare = points.size();
  add_patch(points, PlaneKind::kWall, {0, 0, 0.02}, {1, 0, 0}, {0, 1, 0}, 800, 5, 0.001, 2);
  for (size_t i = bare; i < points.size(); ++i) {
    points[i].certainty = 1;
    points[i].proud = named;
  }
  return points;
}

TEST(ScenePlanes, ADoorStandsBeforeItsWall) {
  const std::vector<ScenePlane> planes = find_planes(wall_with_door(true), {}, 1),
                                taken_for_wall = find_planes(wall_with_door(false), {}, 1);
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_NEAR(planes[0].centre.z, 0, 0.006);
  EXPECT_NEAR(planes[0].centre.z + planes[0].proud, 0.02, 0.002);
  ASSERT_EQ(taken_for_wall.size(), 1u);
  EXPECT_GT(taken_for_wall[0].centre.z, 0.015) << "the wall would come forward";
  EXPECT_EQ(taken_for_wall[0].proud, 0);
}

TEST(ScenePlanes, FindsTheWallsAndTheFloorOfACorner) {
  std::vector<PlanePoint> points = corner(0.01);
  Random random(9);
  for (int i = 0; i < 500; ++i) {  // clutter that was called wall
    PlanePoint p = points[0];
    p.position = {random.uniform(0.3, 3), random.uniform(0.3, 2), random.uniform(0.3, 3)};
    p.normal = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    points.push_back(p);
  }
  const std::vector<ScenePlane> planes = find_planes(points, {}, 1);
  ASSERT_EQ(planes.size(), 3u);
  EXPECT_EQ(planes[0].kind, PlaneKind::kWall);
  EXPECT_LT(angle(planes[0].normal, {0, 0, 1}), 0.3);
  EXPECT_EQ(planes[1].kind, PlaneKind::kFloor);
  EXPECT_LT(angle(planes[1].normal, {0, 1, 0}), 0.3);
  EXPECT_LT(angle(planes[2].normal, {1, 0, 0}), 0.3);
  for (const ScenePlane& plane : planes) {
    EXPECT_LT(std::abs(plane.offset), 0.01);
    EXPECT_EQ(plane.views, 5);
  }
}

TEST(ScenePlanes, TwoSidesOfAThinWallAreTwoPlanes) {
  std::vector<PlanePoint> points;
  add_patch(points, PlaneKind::kWall, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1000, 4, 0.005, 1);
  add_patch(points, PlaneKind::kWall, {0, 0, -0.1}, {0, 1, 0}, {1, 0, 0}, 1000, 4, 0.005, 2);
  EXPECT_EQ(find_planes(points, {}, 1).size(), 2u);
}

TEST(ScenePlanes, WhatStereoMeasuredOutweighsABentPhoto) {
  std::vector<PlanePoint> points;
  add_patch(points, PlaneKind::kWall, {0, 0, 0.06}, {1, 0, 0}, {0, 1, 0}, 3000, 2, 0.002, 1);  // 6 cm off, at 2.5 m
  add_patch(points, PlaneKind::kWall, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 600, 2, 0.002, 2);
  for (size_t i = 3000; i < points.size(); ++i) points[i].certainty = 0.8;
  const std::vector<ScenePlane> planes = find_planes(points, {}, 1);
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_LT(std::abs(planes[0].offset), 0.02);
}

TEST(ScenePlanes, FewPointsOfATurnedPlaneDoNotTurnIt) {
  std::vector<PlanePoint> points;
  // 200 points that say 3 degrees, with the error that the settings expect of a network's depth.
  add_patch(points, PlaneKind::kWall, {0, 0, 0}, {1, 0, 0}, {0, std::cos(0.0524), std::sin(0.0524)}, 200, 2, 0.002, 1);
  for (PlanePoint& p : points) p.normal = {0, 0, 1};
  PlaneSettings held;
  held.turn_sigma = 0.5;
  const auto turn = [](const std::vector<ScenePlane>& planes) {
    return planes.size() == 1 ? angle(planes[0].normal, {0, 0, 1}) : -1;
  };
  EXPECT_NEAR(turn(find_planes(points, {}, 1)), 3, 0.3);
  EXPECT_LT(turn(find_planes(points, held, 1)), 1);
  EXPECT_GE(turn(find_planes(points, held, 1)), 0);
}

TEST(ScenePlanes, OnePhotoAloneMakesNoPlane) {
  std::vector<PlanePoint> points;
  add_patch(points, PlaneKind::kWall, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1000, 1, 0.005, 1);
  EXPECT_TRUE(find_planes(points, {}, 1).empty());
}

TEST(ScenePlanes, NothingFlatMakesNoPlane) {
  std::vector<PlanePoint> points;
  Random random(4);
  for (int i = 0; i < 4000; ++i) {
    PlanePoint p;
    p.normal = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    p.position = p.normal * -2.0;
    p.depth = 2;
    p.view = i % 6;
    p.kind = PlaneKind::kWall;
    points.push_back(p);
  }
  PlaneSettings settings;
  settings.least_share = 0.2;  // a cap of a ball is nearly flat
  EXPECT_TRUE(find_planes(points, settings, 1).empty());
}

TEST(ScenePlanes, PointsWithoutFinitePositionAreIgnored) {
  std::vector<PlanePoint> points = corner(0.01);
  const size_t planes = find_planes(points, {}, 1).size();
  PlanePoint bad = points[0];
  bad.position.y = std::numeric_limits<double>::quiet_NaN();
  points.insert(points.begin(), 100, bad);
  EXPECT_EQ(find_planes(points, {}, 1).size(), planes);
  EXPECT_TRUE(find_planes({}, {}, 1).empty());
}

}  // namespace
}  // namespace aligngs
