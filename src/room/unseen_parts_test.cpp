#include "room/unseen_parts.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

// A wall along x at y = 0, and the room at y > 0.
MeasuredWall back_wall() {
  MeasuredWall wall;
  wall.from = {0, 0};
  wall.to = {4, 0};
  wall.normal = {0, 1, 0};
  wall.height = 2.5;
  return wall;
}

MeasuredBox box_of(const char* name, Vec2d centre, double width, double depth, double bottom, double top) {
  MeasuredBox box;
  box.class_name = name;
  box.centre = centre;
  box.width = width;
  box.depth = depth;
  box.bottom = bottom;
  box.top = top;
  box.support = "unknown";
  return box;
}

/// From the middle of the room to places of the front at y = 0.6, or through it to the wall.
std::vector<SeenRay> rays_to(double y) {
  std::vector<SeenRay> rays;
  for (double x = 1; x <= 3; x += 0.02) {
    for (double z = 0.05; z < 2; z += 0.02) rays.push_back({{2, 4, 1.2}, {x, y, z}, 0});
  }
  return rays;
}

// The front of a wardrobe: 2 m wide, 10 cm thick as it was trained, 50 cm before the wall.
MeasuredBox front() { return box_of("wardrobe", {2, 0.55}, 2, 0.1, 0, 2); }

TEST(UnseenParts, AFrontReachesTheWallBehindIt) {
  std::vector<MeasuredBox> boxes{front()};
  reach_walls(boxes, {back_wall()}, rays_to(0.6));
  EXPECT_NEAR(boxes[0].depth, 0.6, 1e-9);
  EXPECT_NEAR(boxes[0].centre.y, 0.3, 1e-9);
  EXPECT_DOUBLE_EQ(boxes[0].width, 2);
}

TEST(UnseenParts, ATurnedBoxGrowsOnTheSideOfTheWall) {
  std::vector<MeasuredBox> boxes{front()};
  std::swap(boxes[0].width, boxes[0].depth);
  boxes[0].turn = 90;
  reach_walls(boxes, {back_wall()}, rays_to(0.6));
  EXPECT_NEAR(boxes[0].width, 0.6, 1e-9);
  EXPECT_NEAR(boxes[0].centre.y, 0.3, 1e-9);
}

TEST(UnseenParts, SpaceThatPhotosSeeIsNotFilled) {
  std::vector<MeasuredBox> boxes{front()};
  reach_walls(boxes, {back_wall()}, rays_to(0.0));
  EXPECT_DOUBLE_EQ(boxes[0].depth, 0.1);
}

TEST(UnseenParts, WithoutRaysNothingIsAdded) {
  std::vector<MeasuredBox> boxes{front()};
  reach_walls(boxes, {back_wall()}, {});
  EXPECT_DOUBLE_EQ(boxes[0].depth, 0.1);
}

TEST(UnseenParts, AFrontFarFromEveryWallStays) {
  std::vector<MeasuredBox> boxes{front()};
  boxes[0].centre.y = 1.5;
  reach_walls(boxes, {back_wall()}, rays_to(1.6));
  EXPECT_DOUBLE_EQ(boxes[0].depth, 0.1);
}

TEST(UnseenParts, TablesDoNotReachWalls) {
  std::vector<MeasuredBox> boxes{front()};
  boxes[0].class_name = "table";
  reach_walls(boxes, {back_wall()}, rays_to(0.6));
  EXPECT_DOUBLE_EQ(boxes[0].depth, 0.1);
}

TEST(UnseenParts, AThingBehindTheFrontKeepsItsPlace) {
  std::vector<MeasuredBox> boxes{front(), box_of("lamp", {2, 0.25}, 0.3, 0.3, 0, 1.5)};
  reach_walls(boxes, {back_wall()}, rays_to(0.6));
  EXPECT_DOUBLE_EQ(boxes[0].depth, 0.1);
}

TEST(UnseenParts, AFloorLampReachesTheFloorBelowItsShade) {
  std::vector<MeasuredBox> boxes{box_of("lamp", {2, 2}, 0.4, 0.4, 1.2, 1.5)};
  std::vector<SeenRay> rays;
  for (int i = 0; i < 100; ++i) rays.push_back({{2, 4, 1.2}, {2, 2, i < 80 ? 0.5 : 0.01}, 0});  // the pole, the floor
  reach_down(boxes, rays);
  EXPECT_DOUBLE_EQ(boxes[0].bottom, 0);
  EXPECT_DOUBLE_EQ(boxes[0].top, 1.5);
}

TEST(UnseenParts, ALampReachesTheTableThatPhotosShowBelowIt) {
  std::vector<MeasuredBox> boxes{box_of("lamp", {2, 2}, 0.4, 0.4, 1.0, 1.3)};
  std::vector<SeenRay> rays(100, {{2, 4, 1.2}, {2.1, 2.1, 0.7}, 0});
  rays.resize(120, {{2, 4, 1.2}, {2, 2, 0.85}, 0});  // its foot
  reach_down(boxes, rays);
  EXPECT_DOUBLE_EQ(boxes[0].bottom, 0.7);
}

TEST(UnseenParts, APendantLampStays) {
  std::vector<MeasuredBox> boxes{box_of("lamp", {2, 2}, 0.4, 0.4, 1.6, 1.9)};
  const std::vector<SeenRay> rays(100, {{2, 4, 1.2}, {2.1, 2.1, 0.7}, 0});
  reach_down(boxes, rays);
  EXPECT_DOUBLE_EQ(boxes[0].bottom, 1.6);
}

TEST(UnseenParts, ALampWithNothingInSightBelowStays) {
  std::vector<MeasuredBox> boxes{box_of("lamp", {2, 2}, 0.4, 0.4, 1.0, 1.3)};
  reach_down(boxes, {});
  EXPECT_DOUBLE_EQ(boxes[0].bottom, 1.0);
}

TEST(UnseenParts, AChairReachesTheFloorAndAShelfDoesNot) {
  std::vector<MeasuredBox> boxes{box_of("chair", {2, 2}, 0.4, 0.4, 0.4, 0.9),
                                 box_of("shelf", {1, 1}, 0.8, 0.2, 1.4, 1.5)};
  reach_down(boxes, {});
  EXPECT_DOUBLE_EQ(boxes[0].bottom, 0);
  EXPECT_DOUBLE_EQ(boxes[1].bottom, 1.4);
}

TEST(UnseenParts, WhatStandsOnSomethingStays) {
  std::vector<MeasuredBox> boxes{box_of("chair", {2, 2}, 0.4, 0.4, 0.4, 0.9)};
  boxes[0].support = "table.1";
  reach_down(boxes, {});
  EXPECT_DOUBLE_EQ(boxes[0].bottom, 0.4);
}

}  // namespace
}  // namespace aligngs
