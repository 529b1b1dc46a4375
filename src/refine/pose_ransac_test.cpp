#include "refine/pose_ransac.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "core/rotation_vector.h"
#include "refine/bundle_adjustment.h"
#include "refine/testing/small_camera.h"

namespace aligngs {
namespace {

Camera offset_camera() {
  Camera c = small_camera();
  c.world_to_camera.translation = {0.1, -0.2, 0.3};
  return c;
}

/// `true_camera` turned by some degrees and shifted.
Camera elsewhere(Camera c) {
  c.world_to_camera = Rigidd{rotation_of({0.05, -0.08, 0.03}), {0.1, 0.05, -0.1}} * c.world_to_camera;
  return c;
}

/// Projections to `of` of points in a box before it, within half a pixel. The first `wrong` of them are matched up to
/// 40 pixels off.
std::vector<PointMatch> matches(const Camera& of, int count, int wrong) {
  Random random(3);
  std::vector<PointMatch> out;
  for (int i = 0; i < count; ++i) {
    // One after the other: compilers evaluate arguments in orders of their own.
    const double z = random.uniform(1.5, 4), y = random.uniform(10, 230), x = random.uniform(10, 310);
    const Vec3d point = of.unproject(x, y, z);
    const double off = i < wrong ? 40 : 0.5;
    const Vec2d at = of.project(of.world_to_camera * point);
    out.push_back({point, {at.x + random.uniform(-off, off), at.y + random.uniform(-off, off)}});
  }
  return out;
}

TEST(RansacPose, IsFoundAmongFourTimesAsManyWrongMatches) {
  const Camera truth = offset_camera();
  const auto found = ransac_pose(elsewhere(truth), matches(truth, 200, 160), {});
  ASSERT_TRUE(found);
  EXPECT_GE(found->agreeing, 38);
  EXPECT_LT(found->agreeing, 60);
  EXPECT_LT(norm(found->camera.centre() - truth.centre()), 0.02);
  EXPECT_LT(rotation_angle_between_degrees(found->camera.world_to_camera.rotation, truth.world_to_camera.rotation),
            0.3);
}

TEST(RansacPose, KeepsTheLens) {
  const auto found = ransac_pose(elsewhere(offset_camera()), matches(offset_camera(), 50, 0), {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->camera.fx, offset_camera().fx);
  EXPECT_EQ(found->camera.width, offset_camera().width);
}

TEST(RansacPose, IsTheSameEveryTime) {
  const std::vector<PointMatch> some = matches(offset_camera(), 100, 70);
  const auto a = ransac_pose(elsewhere(offset_camera()), some, {}),
             b = ransac_pose(elsewhere(offset_camera()), some, {});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->camera.world_to_camera.translation.x, b->camera.world_to_camera.translation.x);
}

TEST(RansacPose, ThreeMatchesAgreeWithAnything) {
  EXPECT_FALSE(ransac_pose(offset_camera(), matches(offset_camera(), 3, 0), {}));
  EXPECT_FALSE(ransac_pose(offset_camera(), {}, {}));
}

TEST(RansacPose, ThereIsNoneBehindTheCamera) {
  std::vector<PointMatch> behind = matches(offset_camera(), 20, 0);
  for (PointMatch& match : behind) match.point.z = -10;
  EXPECT_FALSE(ransac_pose(offset_camera(), behind, {}));
}

TEST(RansacPose, AFartherTurnThanAllowedIsNone) {
  PoseSearchSettings settings;
  settings.largest_turn = 2;
  const auto found = ransac_pose(elsewhere(offset_camera()), matches(offset_camera(), 100, 0), settings);
  EXPECT_TRUE(!found || found->agreeing < 20);
}

TEST(RansacPose, PointsOnOneLineBreakNothing) {
  std::vector<PointMatch> line = matches(offset_camera(), 40, 0);
  for (size_t i = 0; i < line.size(); ++i) {
    line[i].point = {0.05 * static_cast<double>(i) - 1, 0, 3};
    line[i].pixel = offset_camera().project(offset_camera().world_to_camera * line[i].point);
  }
  const auto found = ransac_pose(elsewhere(offset_camera()), line, {});
  ASSERT_TRUE(found);  // one of many: the photo may be turned about the line
  int agreeing = 0;
  for (const PointMatch& match : line) {
    const Camera& camera = found->camera;
    const Vec2d at = camera.project(camera.world_to_camera * match.point);
    agreeing += std::hypot(at.x - match.pixel.x, at.y - match.pixel.y) < PoseSearchSettings{}.agreement;
  }
  EXPECT_EQ(agreeing, found->agreeing);
  EXPECT_EQ(agreeing, 40);
}

TEST(RansacPose, NoNumbersInAMatchAreLeftOut) {
  std::vector<PointMatch> some = matches(offset_camera(), 100, 0);
  for (size_t i = 0; i < some.size(); i += 4) some[i].pixel.x = std::nan("");
  const auto found = ransac_pose(elsewhere(offset_camera()), some, {});
  ASSERT_TRUE(found);
  EXPECT_LT(norm(found->camera.centre() - offset_camera().centre()), 0.02);
}

}  // namespace
}  // namespace aligngs
