#include "refine/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace aligngs {
namespace {

/// Three cameras in a row that look at points between two and four units away.
BundleProblem exact_problem() {
  BundleProblem problem;
  for (int v = 0; v < 3; ++v) {
    Camera camera;
    camera.width = 200;
    camera.height = 150;
    camera.fx = camera.fy = 180;
    camera.cx = 100;
    camera.cy = 75;
    camera.world_to_camera.translation = {-0.4 * v, 0, 0};
    problem.cameras.push_back(camera);
  }
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const Vec3d point{random.uniform(-0.5, 1.3), random.uniform(-0.7, 0.7), random.uniform(2, 4)};
    for (int v = 0; v < 3; ++v) {
      const Vec3d p = problem.cameras[static_cast<size_t>(v)].world_to_camera * point;
      problem.observations.push_back({v, i, problem.cameras[static_cast<size_t>(v)].project(p), p.z, {}});
    }
    problem.points.push_back(point);
  }
  return problem;
}

/// Sixty points are few: a prior of usual strength would keep half of a deliberate error.
BundleSettings weak_prior() {
  BundleSettings settings;
  settings.rotation = 10;
  settings.centre = 1;
  return settings;
}

class BundleAdjustmentTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!bundle_adjustment_available()) GTEST_SKIP() << "built without Ceres";
  }
};

TEST_F(BundleAdjustmentTest, ExactDataStayAsTheyAre) {
  BundleProblem problem = exact_problem();
  const BundleReport report = adjust_bundle(problem, {});
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(report.end_rms, 0, 1e-6);
  EXPECT_NEAR(problem.focal_factor, 1, 1e-9);
}

TEST_F(BundleAdjustmentTest, AShiftedCameraGoesBack) {
  BundleProblem problem = exact_problem();
  problem.cameras[1].world_to_camera.translation.y += 0.01;
  problem.fixed = {true, false, true};  // so that there is one answer
  const BundleReport report = adjust_bundle(problem, weak_prior());
  EXPECT_GT(report.start_rms, 0.3);
  EXPECT_LT(report.end_rms, 0.05);
  EXPECT_NEAR(problem.cameras[1].world_to_camera.translation.y - problem.cameras[0].world_to_camera.translation.y, 0,
              1e-3);
}

TEST_F(BundleAdjustmentTest, AWrongMatchPullsLittle) {
  BundleProblem problem = exact_problem();
  problem.observations[10].pixel.x += 40;
  adjust_bundle(problem, {});
  EXPECT_NEAR(problem.cameras[1].centre().x, 0.4, 2e-3);
}

TEST_F(BundleAdjustmentTest, APriorThatIsTooFarEverywhereInAViewIsItsScale) {
  BundleProblem problem = exact_problem();
  for (Observation& o : problem.observations) o.prior_depth *= o.view == 2 ? 1 / 1.02 : 1;
  adjust_bundle(problem, {});
  EXPECT_NEAR(problem.depth_scale[2] / problem.depth_scale[0], 1.02, 0.004);
}

TEST_F(BundleAdjustmentTest, FixedPointsAreResection) {
  BundleProblem problem = exact_problem();
  const std::vector<Vec3d> points = problem.points;
  problem.fixed_points = true;
  problem.cameras[2].world_to_camera.translation.z += 0.02;
  BundleSettings settings = weak_prior();
  settings.focal = 0;
  adjust_bundle(problem, settings);
  EXPECT_EQ(problem.points[5].x, points[5].x);
  EXPECT_NEAR(problem.cameras[2].world_to_camera.translation.z, 0, 2e-3);
  EXPECT_EQ(problem.focal_factor, 1);
}

TEST_F(BundleAdjustmentTest, WithoutObservationsNothingChanges) {
  BundleProblem problem = exact_problem();
  problem.observations.clear();
  const BundleReport report = adjust_bundle(problem, {});
  EXPECT_EQ(report.end_rms, 0);
  EXPECT_EQ(problem.cameras[1].world_to_camera.translation.x, -0.4);
}

TEST_F(BundleAdjustmentTest, PointsBehindACameraAreLeftOut) {
  BundleProblem problem = exact_problem();
  problem.points.push_back({0, 0, -2});
  problem.observations.push_back({0, static_cast<int>(problem.points.size()) - 1, {100, 75}, 0, {}});
  EXPECT_TRUE(std::isinf(reprojection_error(problem.cameras[0], problem.points.back(), {100, 75})));
  EXPECT_NEAR(adjust_bundle(problem, {}).end_rms, 0, 1e-6);
  EXPECT_EQ(problem.points.back().z, -2);
}

}  // namespace
}  // namespace aligngs
