#include "room/find_room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "refine/testing/box_room.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

using namespace box_room;

const LabelSet& labels() {
  static const LabelSet set = [] {
    LabelSet out;
    for (const char* name : {"wall", "floor", "ceiling", "chest of drawers"}) out.classes.push_back({name, {}, {}});
    return out;
  }();
  return set;
}

/// Cameras that see all of the box, or its end alone.
RoomInputs inputs(bool all_around) {
  RoomInputs out;
  out.labels = &labels();
  const int turns = all_around ? 12 : 1;
  for (const Vec3d& centre : {Vec3d{0.4, -0.2, -0.6}, Vec3d{-0.5, 0, -1.4}}) {
    for (int k = 0; k < turns; ++k) {
      for (const double dip : {-0.45, 0.1, 0.5})
        out.views.push_back(look(camera(centre, 2 * 3.14159265 * k / turns, dip)).plane);
    }
  }
  return out;
}

MeasuredRoom room_of(const RoomInputs& in) {
  ThreadPool pool(2);
  return find_room(in, {}, pool);
}

TEST(FindRoom, ABoxHasItsMeasures) {
  RoomInputs in = inputs(true);
  in.metres_per_unit = 1;
  in.scale_source = ScaleSource::kSensor;
  const MeasuredRoom room = room_of(in);
  EXPECT_TRUE(room.metric);
  EXPECT_EQ(room.scale_source, ScaleSource::kSensor);
  EXPECT_NEAR(room.height, kFloor - kCeiling, 0.02);
  ASSERT_EQ(room.walls.size(), 4u);
  EXPECT_NEAR(room.area(), 2 * kSide * 2 * kEnd, 0.2);
  EXPECT_NEAR(room.walls[0].length() + room.walls[1].length(), 2 * kSide + 2 * kEnd, 0.05);
  for (const MeasuredWall& wall : room.walls) EXPECT_FALSE(wall.assumed);
}

TEST(FindRoom, TheFrameHasTheFloorAtZeroAndNoNegativeCorner) {
  const MeasuredRoom room = room_of(inputs(true));
  EXPECT_NEAR((room.to_room * Vec3d{0, kFloor, 0}).z, 0, 0.02);
  EXPECT_NEAR(determinant(room.to_room.rotation), 1, 1e-9);
  double least = 1;
  for (const MeasuredWall& wall : room.walls) least = std::min({least, wall.from.x, wall.from.y});
  EXPECT_NEAR(least, 0, 1e-9);
}

TEST(FindRoom, AWorldWithoutUnitIsMeasuredInItsOwn) {
  const MeasuredRoom room = room_of(inputs(true));
  EXPECT_FALSE(room.metric);
  EXPECT_NEAR(room.height, kFloor - kCeiling, 0.02);
  EXPECT_NEAR(room.to_room.scale, 1, 1e-9);
}

TEST(FindRoom, WallsThatNobodySeesAreAssumed) {
  const MeasuredRoom room = room_of(inputs(false));
  const size_t assumed = static_cast<size_t>(
      std::count_if(room.walls.begin(), room.walls.end(), [](const MeasuredWall& w) { return w.assumed; }));
  EXPECT_GE(assumed, 1u);
  EXPECT_LT(assumed, room.walls.size());
  EXPECT_FALSE(room.warnings.empty());
}

TEST(FindRoom, WithoutLabelsThereIsNoRoom) {
  RoomInputs in = inputs(false);
  for (PlaneView& view : in.views) std::fill(view.labels.data.begin(), view.labels.data.end(), kNoLabel);
  EXPECT_THROW(room_of(in), Error);
  in.views.clear();
  EXPECT_THROW(room_of(in), Error);
}

TEST(FindRoom, WithoutFloorCeilingAndUpThereIsNoRoom) {
  RoomInputs in = inputs(true);
  for (PlaneView& view : in.views) std::fill(view.labels.data.begin(), view.labels.data.end(), kChestLabel);
  EXPECT_THROW(room_of(in), Error);
}

TEST(FindRoom, WithoutWallsTheBoxOfWhatIsSeenIsAssumed) {
  RoomInputs in = inputs(true);
  in.up = Vec3d{0, -1, 0};
  for (PlaneView& view : in.views) std::fill(view.labels.data.begin(), view.labels.data.end(), kChestLabel);
  const MeasuredRoom room = room_of(in);
  EXPECT_TRUE(room.floor_assumed);
  EXPECT_TRUE(room.ceiling_assumed);
  for (const MeasuredWall& wall : room.walls) EXPECT_TRUE(wall.assumed);
  EXPECT_EQ(room.warnings.size(), 4u);
}

TEST(FindRoom, FurnitureIsInTheRoom) {
  RoomInputs in = inputs(true);
  ObjectPoints chest{"chest of drawers", 1, {}, 1}, outside = chest;
  for (double x = -0.5; x <= 0.5; x += 0.05) {
    for (double z = -0.5; z <= 0.5; z += 0.05) {
      chest.points.push_back({x, kFloor - 0.5 * (x + 0.5), z});
      outside.points.push_back({x + 10, kFloor - 0.5 * (x + 0.5), z});
    }
  }
  outside.instance = 2;
  in.objects = {chest, outside};
  const MeasuredRoom room = room_of(in);
  ASSERT_EQ(room.boxes.size(), 1u);
  EXPECT_EQ(room.boxes[0].instance, 1);
  EXPECT_EQ(room.boxes[0].support, "floor");
}

TEST(FindRoom, DepthThatIsNotFiniteIsIgnored) {
  RoomInputs in = inputs(true);
  for (PlaneView& view : in.views) {
    for (size_t i = 0; i < view.depth.data.size(); i += 7) view.depth.data[i] = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_NEAR(room_of(in).height, kFloor - kCeiling, 0.03);
}

}  // namespace
}  // namespace aligngs
