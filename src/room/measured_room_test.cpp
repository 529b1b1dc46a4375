#include "room/measured_room.h"

#include <gtest/gtest.h>

#include "room/testing/sample_room.h"

namespace aligngs {
namespace {

TEST(MeasuredRoom, AreaAndPerimeterAreThoseOfTheOutline) {
  const MeasuredRoom room = sample_room::make();
  EXPECT_DOUBLE_EQ(room.area(), 12);
  EXPECT_DOUBLE_EQ(room.perimeter(), 14);
}

TEST(MeasuredRoom, AnEmptyRoomHasNoArea) {
  EXPECT_EQ(MeasuredRoom().area(), 0);
  EXPECT_EQ(MeasuredRoom().perimeter(), 0);
}

TEST(MeasuredRoom, ASlopingCeilingIsTheLowestOfItsPlanes) {
  MeasuredRoom room = sample_room::make();
  // From 1 m at x = 0, rising by 1 in 1.
  const double s = std::sqrt(0.5);
  room.ceiling.push_back({{s, 0, -s}, s});
  EXPECT_NEAR(room.height_at({0, 1}), 1, 1e-12);
  EXPECT_NEAR(room.height_at({0.5, 1}), 1.5, 1e-12);
  EXPECT_NEAR(room.height_at({4, 1}), 2.5, 1e-12);
}

TEST(MeasuredRoom, RescalingMultipliesAllLengthsAndTheMatrix) {
  const MeasuredRoom room = sample_room::make(), twice = rescaled(room, 2);
  EXPECT_DOUBLE_EQ(twice.area(), 48);
  EXPECT_DOUBLE_EQ(twice.height_at({1, 1}), 5);
  EXPECT_DOUBLE_EQ(twice.openings[1].bottom, 1.8);
  EXPECT_DOUBLE_EQ(twice.boxes[0].width, 4);
  const Vec3d p{1, 2, 3};
  EXPECT_NEAR(norm(twice.to_room * p - 2.0 * (room.to_room * p)), 0, 1e-12);
}

TEST(MeasuredRoom, NamesCountPerKind) {
  MeasuredRoom room = sample_room::make();
  room.openings.push_back(room.openings[0]);
  EXPECT_EQ(opening_name(room, 0), "door.1");
  EXPECT_EQ(opening_name(room, 3), "door.2");
  EXPECT_EQ(wall_name(2), "wall.3");
}

TEST(MeasuredRoom, FootprintOfATurnedBoxRunsCounterClockwise) {
  MeasuredBox box;
  box.width = 2;
  box.depth = 1;
  box.turn = 90;
  const std::vector<Vec2d> corners = footprint(box);
  EXPECT_NEAR(signed_area(corners), 2, 1e-12);
  EXPECT_NEAR(corners[0].x, 0.5, 1e-12);
  EXPECT_NEAR(corners[0].y, -1, 1e-12);
}

}  // namespace
}  // namespace aligngs
