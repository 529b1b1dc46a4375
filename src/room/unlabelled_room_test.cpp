#include "room/unlabelled_room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "room/testing/solid_room.h"

namespace aligngs {
namespace {

using namespace solid_room;

constexpr double kWide = 4, kDeep = 3;
const std::vector<Vec2d> kPlaces = {{1.2, 1.3}, {2.6, 1.6}};

RoomInputs unlabelled(const Solids& solids, const std::vector<Vec2d>& places = kPlaces) {
  RoomInputs out;
  out.views = look_around(solids, places);
  out.up = Vec3d{0, -1, 0};
  out.metres_per_unit = 1;
  return out;
}

MeasuredRoom unlabelled_room_of(const RoomInputs& in) {
  ThreadPool pool(2);
  UnlabelledRoomSettings settings;
  settings.structure.across = 50;  // of 160 pixels, for speed
  return find_unlabelled_room(in, settings, pool);
}

Solids with(Solids solids, const Solids& more) {
  solids.insert(solids.end(), more.begin(), more.end());
  return solids;
}

TEST(UnlabelledRoom, ABoxHasItsMeasures) {
  const MeasuredRoom room = unlabelled_room_of(unlabelled(empty_room(kWide, kDeep)));
  EXPECT_NEAR(room.height, kHigh, 0.02);
  ASSERT_EQ(room.walls.size(), 4u);
  EXPECT_NEAR(room.area(), kWide * kDeep, 0.15);
  for (const MeasuredWall& wall : room.walls) EXPECT_FALSE(wall.assumed);
  EXPECT_GT(room.floor_seen, 0.5);
  EXPECT_GT(room.ceiling_seen, 0.5);
}

TEST(UnlabelledRoom, SaysThatNoLabelWasUsed) {
  const MeasuredRoom room = unlabelled_room_of(unlabelled(empty_room(kWide, kDeep)));
  EXPECT_EQ(room.found_by, RoomEvidence::kGeometry);
  ASSERT_EQ(room.warnings.size(), 1u);
  EXPECT_NE(room.warnings[0].find("no labels"), std::string::npos);
  EXPECT_TRUE(room.openings.empty());
  EXPECT_TRUE(room.boxes.empty());
}

TEST(UnlabelledRoom, ATableAndACupboardAreNoWalls) {
  const Solids things = {box(1.4, 2.1, 2.4, 2.8, 0.7, 0.75), box(0, 2.4, 2.2, 3, 0, 2.1),
                         box(3.5, 0.3, 4, 1.5, 0, 0.9)};
  const MeasuredRoom room = unlabelled_room_of(unlabelled(with(empty_room(kWide, kDeep), things)));
  EXPECT_NEAR(room.height, kHigh, 0.02);
  EXPECT_EQ(room.walls.size(), 4u);
  EXPECT_NEAR(room.area(), kWide * kDeep, 0.2);
}

TEST(UnlabelledRoom, ACupboardUpToTheCeilingEndsTheRoom) {
  const Solids cupboard = {box(0, 2.4, kWide, 3, 0, kHigh)};
  const MeasuredRoom room = unlabelled_room_of(unlabelled(with(empty_room(kWide, kDeep), cupboard)));
  EXPECT_NEAR(room.area(), kWide * (kDeep - 0.6), 0.2);
}

TEST(UnlabelledRoom, AnLHasSixWalls) {
  // A corner of 2 m x 1.5 m is missing.
  const Solids solids = with(empty_room(5, 4), {box(3, 2.5, 5.2, 4.2, 0, kHigh)});
  const MeasuredRoom room = unlabelled_room_of(unlabelled(solids, {{1.3, 1.2}, {3.8, 1.3}, {1.5, 3.0}}));
  EXPECT_EQ(room.walls.size(), 6u);
  EXPECT_NEAR(room.area(), 5 * 4 - 2 * 1.5, 0.3);
}

TEST(UnlabelledRoom, AWindowAndADoorwayLeaveTheWallsInPlace) {
  Solids solids = empty_room(kWide, kDeep);
  // The wall x = 4 in pieces around a window, and z = 3 in pieces around a doorway; a yard and a hall lie behind.
  solids.erase(solids.begin() + 3);
  solids.pop_back();
  const double t = kThick;
  solids = with(solids,
                {box(4, -t, 4 + t, 0.6, 0, kHigh), box(4, 2.2, 4 + t, 3 + t, 0, kHigh), box(4, 0.6, 4 + t, 2.2, 0, 0.9),
                 box(4, 0.6, 4 + t, 2.2, 2.1, kHigh), box(-t, 3, 1.5, 3 + t, 0, kHigh),
                 box(2.4, 3, 4 + t, 3 + t, 0, kHigh), box(1.5, 3, 2.4, 3 + t, 2, kHigh),
                 // behind
                 box(8, -9, 8 + t, 12, -1, 6), box(-4, 5, 8, 5 + t, 0, kHigh), box(-4, 3 + t, 8, 5, -t, 0)});
  const MeasuredRoom room = unlabelled_room_of(unlabelled(solids));
  EXPECT_EQ(room.walls.size(), 4u);
  EXPECT_NEAR(room.area(), kWide * kDeep, 0.2);
}

TEST(UnlabelledRoom, AGhostSeenThroughAWindowIsNoWall) {
  Solids solids = empty_room(kWide, kDeep);
  solids.erase(solids.begin() + 3);
  const double t = kThick;
  solids = with(solids,
                {box(4, -t, 4 + t, 0.4, 0, kHigh), box(4, 2.6, 4 + t, 3 + t, 0, kHigh), box(4, 0.4, 4 + t, 2.6, 0, 0.8),
                 box(4, 0.4, 4 + t, 2.6, 2.2, kHigh), box(4.8, -2, 4.8 + t, 5, -1, 5)});
  EXPECT_NEAR(unlabelled_room_of(unlabelled(solids)).area(), kWide * kDeep, 0.2);
}

TEST(UnlabelledRoom, AnUpThatIsWrongByFifteenDegreesIsCorrected) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep));
  in.up = Vec3d{0.26, -0.97, 0};
  const MeasuredRoom room = unlabelled_room_of(in);
  EXPECT_NEAR(room.height, kHigh, 0.02);
  EXPECT_NEAR(room.area(), kWide * kDeep, 0.15);
}

TEST(UnlabelledRoom, WithoutAUnitLengthsAreThoseOfTheWorld) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep));
  in.metres_per_unit.reset();
  const MeasuredRoom room = unlabelled_room_of(in);
  EXPECT_FALSE(room.metric);
  EXPECT_NEAR(room.to_room.scale, 1, 1e-9);
  EXPECT_NEAR(room.height, kHigh, 0.02);
}

TEST(UnlabelledRoom, AWallThatNobodySeesIsAssumed) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep));
  std::erase_if(in.views, [](const PlaneView& view) { return view.camera.forward().x > 0.3; });
  const MeasuredRoom room = unlabelled_room_of(in);
  EXPECT_GE(std::count_if(room.walls.begin(), room.walls.end(), [](const MeasuredWall& w) { return w.assumed; }), 1);
}

TEST(UnlabelledRoom, DepthThatIsNotFiniteIsLeftOut) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep));
  for (PlaneView& view : in.views) {
    for (size_t i = 0; i < view.depth.data.size(); i += 11)
      view.depth.data[i] = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_NEAR(unlabelled_room_of(in).height, kHigh, 0.03);
}

TEST(UnlabelledRoom, PixelsThatNoSurfaceCoversAreLeftOut) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep));
  for (PlaneView& view : in.views) {
    view.certainty = ImageF(view.depth.width, view.depth.height, 1, 1.0f);
    for (int y = 0; y < view.depth.height; ++y) {
      for (int x = 0; x < 40; ++x) view.depth.at(x, y) = 30, view.certainty.at(x, y) = 0;
    }
  }
  EXPECT_NEAR(unlabelled_room_of(in).area(), kWide * kDeep, 0.2);
}

TEST(UnlabelledRoom, NothingSeenIsNoRoom) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep), {{2, 1.5}});
  for (PlaneView& view : in.views) std::fill(view.depth.data.begin(), view.depth.data.end(), 0.0f);
  EXPECT_THROW(unlabelled_room_of(in), Error);
  in.views.clear();
  EXPECT_THROW(unlabelled_room_of(in), Error);
}

TEST(UnlabelledRoom, ThingsOnALawnAreNoRoom) {
  const Solids lawn = {box(-20, -20, 20, 20, -0.2, 0), box(1, 2, 1.6, 2.6, 0, 0.9), box(2.5, 0, 3, 0.4, 0, 1.1)};

  EXPECT_THROW(unlabelled_room_of(unlabelled(lawn)), Error);
}

TEST(UnlabelledRoom, TheSameDepthEverywhereIsNoRoom) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep));
  for (PlaneView& view : in.views) std::fill(view.depth.data.begin(), view.depth.data.end(), 2.0f);
  EXPECT_THROW(unlabelled_room_of(in), Error);
}

TEST(UnlabelledRoom, WithoutUpThereIsNoRoom) {
  RoomInputs in = unlabelled(empty_room(kWide, kDeep), {{2, 1.5}});
  in.up.reset();
  EXPECT_THROW(unlabelled_room_of(in), Error);
}

}  // namespace
}  // namespace aligngs
