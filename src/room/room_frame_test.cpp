#include "room/room_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace aligngs {
namespace {

/// y points down, as in the world of cameras.
ScenePlane plane(PlaneKind kind, const Vec3d& normal, double offset, size_t points = 100) {
  ScenePlane p;
  p.kind = kind;
  p.normal = normal;
  p.offset = offset;
  p.centre = normal * -offset;
  p.points = points;
  return p;
}

TEST(RoomFrame, TheFloorIsAtZeroAndUpIsZ) {
  const auto frame = find_room_frame({plane(PlaneKind::kFloor, {0, -1, 0}, 1.2)}, std::nullopt);
  ASSERT_TRUE(frame.has_value());
  EXPECT_NEAR((frame->to_room * Vec3d{3, 1.2, -2}).z, 0, 1e-12);
  EXPECT_NEAR((frame->to_room * Vec3d{0, -1, 0}).z, 2.2, 1e-12);
  EXPECT_NEAR(determinant(frame->to_room.rotation), 1, 1e-12);
}

TEST(RoomFrame, ACeilingAloneSaysWhereUpIs) {
  const auto frame = find_room_frame({plane(PlaneKind::kCeiling, {0, 1, 0}, 1)}, std::nullopt);
  ASSERT_TRUE(frame.has_value());
  EXPECT_FALSE(frame->floor.has_value());
  EXPECT_NEAR((frame->to_room.rotation * Vec3d{0, -1, 0}).z, 1, 1e-12);
}

TEST(RoomFrame, WithoutFloorCeilingAndUpThereIsNone) {
  EXPECT_FALSE(find_room_frame({}, std::nullopt).has_value());
  EXPECT_FALSE(find_room_frame({plane(PlaneKind::kWall, {1, 0, 0}, 1)}, std::nullopt).has_value());
}

TEST(RoomFrame, APlaneThatIsNotFiniteIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(find_room_frame({plane(PlaneKind::kFloor, {nan, nan, nan}, nan)}, std::nullopt).has_value());
}

TEST(RoomFrame, AFloorThatContradictsUpIsNone) {
  const auto frame = find_room_frame({plane(PlaneKind::kFloor, {1, 0, 0}, 1)}, Vec3d{0, -1, 0});
  ASSERT_TRUE(frame.has_value());
  EXPECT_FALSE(frame->floor.has_value());
}

TEST(RoomFrame, WallsAreUprightAndTheLargestRunsAlongX) {
  const double s = std::sqrt(0.5);
  const auto frame =
      find_room_frame({plane(PlaneKind::kFloor, {0, -1, 0}, 1), plane(PlaneKind::kWall, {s, 0, s}, 2, 500),
                       plane(PlaneKind::kWall, {0, s, s}, 2, 900)},
                      std::nullopt);
  ASSERT_TRUE(frame.has_value());
  ASSERT_EQ(frame->walls, std::vector<size_t>{1});
  EXPECT_NEAR((frame->to_room.rotation * Vec3d{s, 0, s}).x, 0, 1e-12);
}

TEST(RoomFrame, APlaneMovesWithItsPoints) {
  const Rigidd motion{{{0, 1, 0, 0, 0, 1, 1, 0, 0}}, {1, 2, 3}};
  const ScenePlane before = plane(PlaneKind::kWall, {1, 0, 0}, -2), after = in_frame(before, motion);
  EXPECT_NEAR(after.distance(motion * Vec3d{2, 7, 8}), 0, 1e-12);
  EXPECT_NEAR(after.distance(motion * Vec3d{5, 7, 8}), 3, 1e-12);
}

}  // namespace
}  // namespace aligngs
