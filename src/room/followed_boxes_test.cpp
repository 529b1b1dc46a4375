#include "room/followed_boxes.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

/// The surface of a block whose middle is at (x, y), on the floor.
ObjectPoints block_at(const char* name, int instance, double x, double y) {
  ObjectPoints out{name, instance, {}, 0.9};
  constexpr int kSteps = 30;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const double a = static_cast<double>(i) / kSteps - 0.5, b = static_cast<double>(j) / kSteps - 0.5;
      for (const Vec3d& p : {Vec3d{a, b, 1}, Vec3d{a, -0.5, b + 0.5}, Vec3d{a, 0.5, b + 0.5}, Vec3d{-0.5, a, b + 0.5},
                             Vec3d{0.5, a, b + 0.5}})
        out.points.push_back({x + 1.2 * p.x, y + 0.6 * p.y, 0.8 * p.z});
    }
  }
  return out;
}

/// A room of 5 x 4 m with two chests, whose boxes photos show a part of.
class FollowedBoxes : public testing::Test {
 protected:
  FollowedBoxes() {
    const Vec2d corners[] = {{0, 0}, {5, 0}, {5, 4}, {0, 4}};
    const Vec3d normals[] = {{0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 0, 0}};
    for (size_t i = 0; i < 4; ++i) {
      MeasuredWall wall;
      wall.from = corners[i];
      wall.to = corners[(i + 1) % 4];
      wall.normal = normals[i];
      room_.walls.push_back(wall);
    }
    room_.height = 2.5;
    room_.boxes = find_boxes(join_pieces({first(), second()}), {room_.walls, {}, room_.height});
    room_.boxes[0].depth += 0.2;  // the back, which no photo shows
    room_.boxes[0].centre.y += 0.1;
  }
  static ObjectPoints first() { return block_at("cabinet", 1, 1.5, 1); }
  static ObjectPoints second() { return block_at("desk", 1, 3.5, 3); }
  MeasuredRoom room_;
};

TEST_F(FollowedBoxes, ThingsAsTheyWereKeepTheirBoxes) {
  ASSERT_EQ(room_.boxes.size(), 2u);
  const auto boxes = followed_boxes(room_, {first(), second()});
  ASSERT_EQ(boxes.size(), 2u);
  EXPECT_EQ(boxes[0].depth, room_.boxes[0].depth) << "with the part that no photo shows";
  EXPECT_EQ(boxes[1].centre.x, room_.boxes[1].centre.x);
}

TEST_F(FollowedBoxes, AThingThatIsGoneHasNone) {
  const auto boxes = followed_boxes(room_, {second()});
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_EQ(boxes[0].class_name, "desk");
}

TEST_F(FollowedBoxes, AThingThatMovedTakesItsBoxAlong) {
  const auto boxes = followed_boxes(room_, {block_at("cabinet", 1, 2, 1.25), second()});
  ASSERT_EQ(boxes.size(), 2u);
  EXPECT_NEAR(boxes[0].centre.x, 2, 0.02);
  EXPECT_NEAR(boxes[0].centre.y, 1.35, 0.02);
  EXPECT_EQ(boxes[0].depth, room_.boxes[0].depth);
}

TEST_F(FollowedBoxes, AThingThatIsNewHasTheBoxOfItsPoints) {
  const auto boxes = followed_boxes(room_, {first(), second(), block_at("cabinet", 2, 3.5, 1)});
  ASSERT_EQ(boxes.size(), 3u);
  EXPECT_NEAR(boxes[2].depth, 0.6, 0.04);
}

TEST_F(FollowedBoxes, ThingsOutsideTheWallsAreLeftOut) {
  EXPECT_EQ(followed_boxes(room_, {first(), block_at("desk", 1, 9, 3)}).size(), 1u);
}

TEST_F(FollowedBoxes, AFileOfAnEarlierProgramCannotBeFollowed) {
  EXPECT_TRUE(can_follow(room_.boxes));
  room_.boxes[1].shown.reset();
  EXPECT_FALSE(can_follow(room_.boxes));
}

}  // namespace
}  // namespace aligngs
