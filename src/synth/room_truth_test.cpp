#include "synth/room_truth.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "synth/mesh_builder.h"
#include "synth/rooms.h"

namespace aligngs {
namespace {

class RoomTruth : public testing::TestWithParam<std::string> {};

TEST_P(RoomTruth, MeasuresAreThoseOfTheModel) {
  const RoomModel model = build_room({GetParam(), 1, true});
  const MeasuredRoom room = room_truth(model);
  EXPECT_NEAR(room.area(), model.width * model.depth, 1e-9);
  EXPECT_EQ(room.height, model.height);
  EXPECT_EQ(room.openings.size() >= model.openings.size(), true);
  EXPECT_GE(model.openings.size(), 2u) << "a door and a window";
}

TEST_P(RoomTruth, OpeningsLieOnTheirWallsAndBoxesInTheRoom) {
  const RoomModel model = build_room({GetParam(), 1, true});
  const MeasuredRoom room = room_truth(model);
  for (const MeasuredOpening& o : room.openings) {
    EXPECT_GE(o.left, 0);
    EXPECT_LE(o.right, room.walls[static_cast<size_t>(o.wall)].length());
    EXPECT_LT(o.bottom, o.top);
    EXPECT_LE(o.top, model.height);
  }
  EXPECT_GE(room.boxes.size(), 5u);
  for (const MeasuredBox& box : room.boxes) {
    for (const Vec2d& p : footprint(box)) {
      EXPECT_GT(std::min({p.x, p.y, model.width - p.x, model.depth - p.y}), -0.3) << box_name(box);
    }
  }
}

TEST_P(RoomTruth, TheDescriptionDoesNotDependOnTheWorld) {
  const RoomModel model = build_room({GetParam(), 1, true});
  RoomModel moved = model;
  moved.move_to_world(placement({3, -2, 1}, 40));
  const MeasuredRoom here = room_truth(model), there = room_truth(moved);
  ASSERT_EQ(here.boxes.size(), there.boxes.size());
  for (size_t i = 0; i < here.boxes.size(); ++i) EXPECT_NEAR(here.boxes[i].centre.x, there.boxes[i].centre.x, 0.02);
  EXPECT_NEAR(norm(there.to_room * Vec3d{3, -2, 1}), 0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Kinds, RoomTruth, testing::Values("bedroom", "living", "kitchen", "office"));

}  // namespace
}  // namespace aligngs
