#include "refine/room_axes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

ScenePlane plane_of_room(PlaneKind kind, const Vec3d& normal, size_t points = 1000) {
  ScenePlane out;
  out.kind = kind;
  out.normal = normalized(normal);
  out.centre = out.normal * -2.0;  // a room of 4 m around the origin
  out.offset = 2;
  out.points = points;
  return out;
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, std::abs(dot(a, b)))) * kDegreesPerRadian;
}

/// A room turned in the world, its planes a degree or two off.
std::vector<ScenePlane> bent_room() {
  const Vec3d x = normalized(Vec3d{1, 0.3, 0.1}), z = normalized(cross(x, {0.1, 1, 0})), y = cross(z, x);
  return {plane_of_room(PlaneKind::kFloor, y + x * 0.02), plane_of_room(PlaneKind::kCeiling, -y + x * 0.02),
          plane_of_room(PlaneKind::kWall, x + y * 0.03), plane_of_room(PlaneKind::kWall, -x + y * 0.03),
          plane_of_room(PlaneKind::kWall, z)};
}

TEST(RoomAxes, AreFoundInATurnedRoomWhosePlanesAreBent) {
  const auto axes = estimate_room_axes(bent_room());
  ASSERT_TRUE(axes);
  EXPECT_EQ(axes->share, 1);
  const Vec3d x = normalized(Vec3d{1, 0.3, 0.1}), z = normalized(cross(x, {0.1, 1, 0})), y = cross(z, x);
  for (const Vec3d& truth : {x, y, z}) {
    double least = 90;
    for (int k = 0; k < 3; ++k) least = std::min(least, degrees_between(truth, axes->axes.column(k)));
    EXPECT_LT(least, 0.3);
  }
  EXPECT_NEAR(determinant(axes->axes), 1, 1e-12);
}

TEST(RoomAxes, UpIsWhereFloorsFaceAndCeilingsDoNot) {
  const auto axes = estimate_room_axes(bent_room());
  ASSERT_TRUE(axes && axes->up);
  EXPECT_GT(dot(*axes->up, bent_room()[0].normal), 0.99);
  std::vector<ScenePlane> walls = {plane_of_room(PlaneKind::kWall, {1, 0, 0}),
                                   plane_of_room(PlaneKind::kWall, {0, 0, 1})};
  EXPECT_FALSE(estimate_room_axes(walls)->up) << "walls alone do not say";
}

TEST(RoomAxes, PlanesAlongThemBecomeSquareAndTurnAboutTheirCentre) {
  const std::vector<ScenePlane> bent = bent_room();
  const std::vector<ScenePlane> square = squared_planes(bent, *estimate_room_axes(bent));
  for (size_t i = 0; i < bent.size(); ++i) {
    EXPECT_NEAR(square[i].distance(bent[i].centre), 0, 1e-9);
    for (size_t k = 0; k < bent.size(); ++k) {
      const double cosine = std::abs(dot(square[i].normal, square[k].normal));
      EXPECT_LT(std::min(cosine, 1 - cosine), 1e-9);
    }
  }
}

TEST(RoomAxes, ASlopingCeilingStaysAsItIs) {
  std::vector<ScenePlane> planes = bent_room();
  planes[1] = plane_of_room(PlaneKind::kCeiling, {0.6, -1, 0}, 300);
  const auto axes = estimate_room_axes(planes);
  ASSERT_TRUE(axes);
  EXPECT_LT(axes->share, 1);
  EXPECT_EQ(squared_planes(planes, *axes)[1].normal.x, planes[1].normal.x);
}

TEST(RoomAxes, ARoomThatIsNotSquareHasNone) {
  std::vector<ScenePlane> planes;
  for (int k = 0; k < 6; ++k) {  // six walls of a hexagon, of which two are at a right angle to the floor each
    planes.push_back(plane_of_room(PlaneKind::kWall, {std::cos(k * kPi / 3), 0, std::sin(k * kPi / 3)}));
  }
  planes.push_back(plane_of_room(PlaneKind::kFloor, {0, 1, 0}, 1000));
  EXPECT_FALSE(estimate_room_axes(planes));
}

TEST(RoomAxes, OnePlaneOrParallelOnesSayTooLittle) {
  EXPECT_FALSE(estimate_room_axes({}));
  EXPECT_FALSE(estimate_room_axes({plane_of_room(PlaneKind::kFloor, {0, 1, 0})}));
  EXPECT_FALSE(estimate_room_axes(
      {plane_of_room(PlaneKind::kFloor, {0, 1, 0}), plane_of_room(PlaneKind::kCeiling, {0, -1, 0})}));
}

}  // namespace
}  // namespace aligngs
