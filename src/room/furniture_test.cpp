#include "room/furniture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/angles.h"

namespace aligngs {
namespace {

/// The surface of a box w x d x h whose centre is at (x, y), turned by degrees, from `bottom` up.
ObjectPoints box_points(double w, double d, double h, double x, double y, double degrees, double bottom = 0) {
  ObjectPoints out{"sofa", 1, {}, 0.9};
  const double c = std::cos(degrees * kRadiansPerDegree), s = std::sin(degrees * kRadiansPerDegree);
  constexpr int kN = 40;
  for (int i = 0; i <= kN; ++i) {
    for (int j = 0; j <= kN; ++j) {
      const double a = static_cast<double>(i) / kN - 0.5, b = static_cast<double>(j) / kN - 0.5;
      for (const Vec3d& p : {Vec3d{a, b, 1}, Vec3d{a, -0.5, b + 0.5}, Vec3d{a, 0.5, b + 0.5}, Vec3d{-0.5, a, b + 0.5},
                             Vec3d{0.5, a, b + 0.5}}) {
        out.points.push_back({x + c * p.x * w - s * p.y * d, y + s * p.x * w + c * p.y * d, bottom + p.z * h});
      }
    }
  }
  return out;
}

TEST(Furniture, ATurnedBoxIsFoundWithItsTurn) {
  MeasuredBox box;
  ASSERT_TRUE(fit_box(box_points(2, 0.8, 0.9, 1, 2, 30), {}, box));
  EXPECT_NEAR(box.turn, 30, 2.1);
  EXPECT_NEAR(box.width, 2, 0.06);
  EXPECT_NEAR(box.depth, 0.8, 0.06);
  EXPECT_NEAR(box.top, 0.9, 0.03);
  EXPECT_NEAR(box.centre.x, 1, 0.02);
  EXPECT_NEAR(box.centre.y, 2, 0.02);
  EXPECT_GT(box.seen, 0.9);
}

TEST(Furniture, StraysDoNotGrowTheBox) {
  ObjectPoints points = box_points(2, 0.8, 0.9, 0, 0, 0);
  for (int i = 0; i < 10; ++i) points.points.push_back({50, 50, 50});
  MeasuredBox box;
  ASSERT_TRUE(fit_box(points, {}, box));
  EXPECT_LT(box.width, 2.1);
}

TEST(Furniture, PointsThatAreNotFiniteAreIgnored) {
  ObjectPoints points = box_points(2, 0.8, 0.9, 0, 0, 0);
  MeasuredBox clean, box;
  ASSERT_TRUE(fit_box(points, {}, clean));
  points.points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  ASSERT_TRUE(fit_box(points, {}, box));
  EXPECT_NEAR(box.width, clean.width, 1e-9);
  EXPECT_NEAR(box.depth, clean.depth, 1e-9);
  EXPECT_NEAR(box.top, clean.top, 1e-9);
  EXPECT_NEAR(box.centre.x, clean.centre.x, 1e-9);
}

TEST(Furniture, TooFewPointsAreNoBox) {
  MeasuredBox box;
  EXPECT_FALSE(fit_box({"sofa", 1, {}, 1}, {}, box));
  EXPECT_FALSE(fit_box({"sofa", 1, {{0, 0, 0}, {1, 1, 1}}, 1}, {}, box));
}

TEST(Furniture, AllPointsInOnePlaceAreNoBox) {
  MeasuredBox box;
  EXPECT_FALSE(fit_box({"sofa", 1, std::vector<Vec3d>(100, {1, 1, 1}), 1}, {}, box));
}

TEST(Furniture, OfABoxThatShowsTwoSidesTheTurnIsRight) {
  ObjectPoints corner = box_points(1.4, 0.6, 2.2, 0, 0, 0);
  std::erase_if(corner.points, [](const Vec3d& p) { return p.x > -0.69 && p.y > -0.29; });
  MeasuredBox box;
  ASSERT_TRUE(fit_box(corner, {}, box));
  EXPECT_EQ(box.turn, 0);
}

TEST(Furniture, ABoxThatReachesIntoItsWallIsCutBack) {
  const MeasuredWall wall{{-3, 0}, {3, 0}, {0, 1, 0}, 2.5, 1, 1, false};
  const std::vector<MeasuredBox> boxes = find_boxes({box_points(1, 0.4, 1, 0, 0.14, 0)}, {{wall}, {}, 2.5});
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].centre.y - boxes[0].depth / 2, 0, 1e-9);
  EXPECT_NEAR(boxes[0].depth, 0.34, 0.03);
}

TEST(Furniture, ABoxWhoseTurnPushesItThroughAWallIsSquare) {
  MeasuredWall wall;
  wall.from = {-2, 0};
  wall.to = {2, 0};
  wall.normal = {0, 1, 0};
  // A chest at 20 degrees whose corner would be 8 cm behind the wall, and the same in the open.
  const ObjectPoints turned = box_points(1, 0.4, 0.8, 0, 0.28, 20);
  EXPECT_DOUBLE_EQ(find_boxes({turned}, {{wall}, {}, 2.5})[0].turn, 0);
  EXPECT_NEAR(find_boxes({turned}, {})[0].turn, 20, 2.1);
}

TEST(Furniture, ABedOfHalfAMetreIsNone) {
  ObjectPoints bed = box_points(0.5, 0.4, 0.3, 0, 1, 0);
  bed.class_name = "bed";
  MeasuredBox box;
  EXPECT_FALSE(fit_box(bed, {}, box));
}

TEST(Furniture, PiecesOfABedAreOneThingAndTwoChairsAreTwo) {
  for (const char* name : {"bed", "chair"}) {
    std::vector<ObjectPoints> pieces = {box_points(1.8, 0.6, 0.6, 0, 0, 0), box_points(1.8, 1.2, 0.6, 0, 1, 0)};
    for (ObjectPoints& piece : pieces) piece.class_name = name;
    EXPECT_EQ(join_pieces(pieces).size(), std::string(name) == "bed" ? 1u : 2u);
  }
  EXPECT_TRUE(join_pieces({{"bed", 1, {}, 1}}).empty());
}

TEST(Furniture, BoxesStandOnTheFloorOnEachOtherOrHang) {
  const MeasuredWall wall{{-3, 0}, {3, 0}, {0, 1, 0}, 2.5, 1, 1, false};
  std::vector<ObjectPoints> objects = {box_points(2, 0.8, 0.9, 0, 1.5, 0), box_points(0.4, 0.4, 0.4, 0, 1.5, 0, 0.92),
                                       box_points(1, 0.3, 0.5, 0, 0.16, 0, 1.5), box_points(0.4, 0.4, 0.4, 0, 3, 0, 1)};
  for (size_t i = 0; i < objects.size(); ++i) {
    objects[i].class_name = "cabinet";
    objects[i].instance = static_cast<int>(i) + 1;
  }
  const std::vector<MeasuredBox> boxes = find_boxes(objects, {{wall}, {}, 2.5});
  ASSERT_EQ(boxes.size(), 4u);
  EXPECT_EQ(boxes[0].support, "floor");
  EXPECT_EQ(boxes[1].support, "cabinet.1");
  EXPECT_EQ(boxes[2].support, "wall");
  EXPECT_EQ(boxes[3].support, "unknown");
}

}  // namespace
}  // namespace aligngs
