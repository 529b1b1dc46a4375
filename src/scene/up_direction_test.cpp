#include "scene/up_direction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/quaternion.h"
#include "core/random.h"

namespace aligngs {
namespace {

const Vec3d kUp = normalized(Vec3d{0.2, 0.1, 1});

/// Cameras at a height of 1.5 that look down by 20 degrees on the mean, in a ring around the middle of the room.
std::vector<ViewUp> ring(int count) {
  const Vec3d east = normalized(cross(Vec3d{0, 1, 0}, kUp)), north = cross(kUp, east);
  std::vector<ViewUp> views;
  for (int i = 0; i < count; ++i) {
    const double turn = 6.2831853 * i / count, down = 0.35;
    const Vec3d out = east * std::cos(turn) + north * std::sin(turn);
    views.push_back({kUp * 1.5 + out, kUp * std::cos(down) - out * std::sin(down)});
  }
  return views;
}

/// A floor at height 0, a table top at 0.7 and walls.
std::vector<Vec3d> room() {
  const Vec3d east = normalized(cross(Vec3d{0, 1, 0}, kUp)), north = cross(kUp, east);
  Random random(3);
  std::vector<Vec3d> points;
  for (int i = 0; i < 3000; ++i) {
    const double x = random.uniform(-2, 2), y = random.uniform(-2, 2), noise = random.uniform(-0.005, 0.005);
    if (i % 3 == 0)
      points.push_back(east * x + north * y + kUp * noise);
    else if (i % 3 == 1)
      points.push_back(east * (0.2 * x) + north * (0.2 * y) + kUp * (0.7 + noise));
    else
      points.push_back(east * 2.0 + north * y + kUp * random.uniform(0, 2.5));
  }
  return points;
}

double degrees(const Vec3d& a, const Vec3d& b) { return std::acos(std::min(1.0, dot(a, b))) * 57.29578; }

TEST(UpDirection, TheFloorLabelsDecide) {
  std::vector<Vec3d> floor;
  for (const Vec3d& p : room()) {
    if (std::fabs(dot(p, kUp)) < 0.01) floor.push_back(p);
  }
  const auto up = estimate_up(ring(6), floor, {});
  ASSERT_TRUE(up);
  EXPECT_EQ(up->source, "floor labels");
  EXPECT_LT(degrees(up->direction, kUp), 0.5);
}

TEST(UpDirection, TheLowestPlaneBelowTheCamerasIsTheFloor) {
  const auto up = estimate_up(ring(3), {}, room());
  ASSERT_TRUE(up);
  EXPECT_EQ(up->source, "fitted floor plane");
  EXPECT_LT(degrees(up->direction, kUp), 0.5);
}

TEST(UpDirection, WithoutPointsTheCamerasDecide) {
  const auto up = estimate_up(ring(8), {}, {});
  ASSERT_TRUE(up);
  EXPECT_EQ(up->source, "mean up of the cameras");
  EXPECT_LT(degrees(up->direction, kUp), 1e-3);
}

TEST(UpDirection, CamerasThatCancelEachOtherSayNothing) {
  EXPECT_FALSE(estimate_up({{{}, {0, 0, 1}}, {{}, {0, 0, -1}}}, {}, {}));
  EXPECT_FALSE(estimate_up({}, {}, {}));
}

/// Cameras that look along the horizon and turn in place, their up as given for each turn.
std::vector<ViewUp> level_cameras(const Vec3d& up, double turn) {
  std::vector<ViewUp> views;
  for (int i = 0; i < 8; ++i)
    views.push_back({{}, rotation_matrix(Quaterniond{std::cos(turn * i / 2), 0, 0, std::sin(turn * i / 2)}) * up});
  return views;
}

TEST(UpOfALayout, AConventionThatTheCamerasContradictDoesNotCount) {
  EXPECT_TRUE(agrees_with(ring(12), kUp, false));
  EXPECT_FALSE(agrees_with(level_cameras({0, 0, 1}, 0.5), {0, 1, 0}, false)) << "a world whose up is +z, not +y";
  EXPECT_FALSE(agrees_with(level_cameras({0, 0, -1}, 0.5), {0, 0, 1}, false));
}

TEST(UpOfALayout, PhotosThatWereHeldUprightSayNothing) {
  constexpr double kHalfCircle = 3.14159265358979 / 8;  // an eighth of it for each of eight cameras
  EXPECT_TRUE(agrees_with(level_cameras({0, 1, 0}, 2 * kHalfCircle), {0, 0, 1}, false));
}

TEST(UpOfALayout, ASensorIsContradictedByCamerasUpsideDownAlone) {
  EXPECT_TRUE(agrees_with(level_cameras({0, 1, 0}, 0.05), {0, 0, 1}, true));
  EXPECT_FALSE(agrees_with(level_cameras({0, 0, -1}, 0.05), {0, 0, 1}, true));
}

TEST(ViewUp, FollowsTheOrientationInWhichAPictureWasHeld) {
  const Rigidd still;
  EXPECT_EQ(view_up(still, 1).up.y, -1);
  EXPECT_EQ(view_up(still, 3).up.y, 1);
  EXPECT_EQ(view_up(still, 6).up.x, -1);  // turned clockwise to be seen, its left side comes to the top
  EXPECT_EQ(view_up(still, 8).up.x, 1);
}

}  // namespace
}  // namespace aligngs
