#include "refine/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.h"
#include "refine/bundle_system.h"

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
  ThreadPool pool_{2};
};

TEST_F(BundleAdjustmentTest, ExactDataStayAsTheyAre) {
  BundleProblem problem = exact_problem();
  const BundleReport report = adjust_bundle(problem, {}, pool_);
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(report.end_rms, 0, 1e-6);
  EXPECT_NEAR(problem.focal_factor, 1, 1e-9);
}

TEST_F(BundleAdjustmentTest, AShiftedCameraGoesBack) {
  BundleProblem problem = exact_problem();
  problem.cameras[1].world_to_camera.translation.y += 0.01;
  problem.fixed = {true, false, true};  // so that there is one answer
  const BundleReport report = adjust_bundle(problem, weak_prior(), pool_);
  EXPECT_GT(report.start_rms, 0.3);
  EXPECT_LT(report.end_rms, 0.05);
  EXPECT_NEAR(problem.cameras[1].world_to_camera.translation.y - problem.cameras[0].world_to_camera.translation.y, 0,
              1e-3);
}

TEST_F(BundleAdjustmentTest, AWrongMatchPullsLittle) {
  BundleProblem problem = exact_problem();
  problem.observations[10].pixel.x += 40;
  adjust_bundle(problem, {}, pool_);
  EXPECT_NEAR(problem.cameras[1].centre().x, 0.4, 2e-3);
}

TEST_F(BundleAdjustmentTest, APriorThatIsTooFarEverywhereInAViewIsItsScale) {
  BundleProblem problem = exact_problem();
  for (Observation& o : problem.observations) o.prior_depth *= o.view == 2 ? 1 / 1.02 : 1;
  adjust_bundle(problem, {}, pool_);
  EXPECT_NEAR(problem.depth_scale[2] / problem.depth_scale[0], 1.02, 0.004);
}

TEST_F(BundleAdjustmentTest, FixedPointsAreResection) {
  BundleProblem problem = exact_problem();
  const std::vector<Vec3d> points = problem.points;
  problem.fixed_points = true;
  problem.cameras[2].world_to_camera.translation.z += 0.02;
  BundleSettings settings = weak_prior();
  settings.focal = 0;
  adjust_bundle(problem, settings, pool_);
  EXPECT_EQ(problem.points[5].x, points[5].x);
  EXPECT_NEAR(problem.cameras[2].world_to_camera.translation.z, 0, 2e-3);
  EXPECT_EQ(problem.focal_factor, 1);
}

TEST_F(BundleAdjustmentTest, WithoutObservationsNothingChanges) {
  BundleProblem problem = exact_problem();
  problem.observations.clear();
  const BundleReport report = adjust_bundle(problem, {}, pool_);
  EXPECT_EQ(report.end_rms, 0);
  EXPECT_EQ(problem.cameras[1].world_to_camera.translation.x, -0.4);
}

TEST_F(BundleAdjustmentTest, PointsBehindACameraAreLeftOut) {
  BundleProblem problem = exact_problem();
  problem.points.push_back({0, 0, -2});
  problem.observations.push_back({0, static_cast<int>(problem.points.size()) - 1, {100, 75}, 0, {}});
  EXPECT_TRUE(std::isinf(reprojection_error(problem.cameras[0], problem.points.back(), {100, 75})));
  EXPECT_NEAR(adjust_bundle(problem, {}, pool_).end_rms, 0, 1e-6);
  EXPECT_EQ(problem.points.back().z, -2);
}

/// Cameras, points and depths that disagree a little everywhere.
BundleProblem noisy_problem() {
  BundleProblem problem = exact_problem();
  Random random(7);
  for (Observation& o : problem.observations) {
    o.pixel.x += random.uniform(-0.5, 0.5);
    o.pixel.y += random.uniform(-0.5, 0.5);
    o.prior_depth *= random.uniform(0.95, 1.05);
  }
  for (Vec3d& p : problem.points) p.z += random.uniform(-0.05, 0.05);
  return problem;
}

TEST_F(BundleAdjustmentTest, NoSmallStepFromTheEndIsBetter) {
  BundleProblem problem = noisy_problem();
  problem.anchors = problem.cameras;
  BundleSettings settings;
  settings.tolerance = 1e-12;
  const double focal_before = problem.cameras[0].fx;
  adjust_bundle(problem, settings, pool_);
  const BundleSystem system(problem, settings, pool_);
  BundleState end = system.start();
  end.log_focal = std::log(problem.cameras[0].fx / focal_before);
  for (size_t v = 0; v < end.log_scales.size(); ++v) end.log_scales[v] = std::log(problem.depth_scale[v]);
  const double cost = system.cost(end);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {-1e-4, 1e-4}) {
      for (size_t i = 0; i < end.points.size(); ++i) {
        BundleState moved = end;
        moved.points[i][axis] += step;
        EXPECT_GE(system.cost(moved), cost) << "point " << i << ", axis " << axis;
      }
      for (size_t v = 0; v < end.cameras.size(); ++v) {
        BundleState moved = end;
        moved.cameras[v].world_to_camera.translation[axis] += step;
        EXPECT_GE(system.cost(moved), cost) << "camera " << v << ", axis " << axis;
      }
    }
  }
}

TEST_F(BundleAdjustmentTest, AnyNumberOfThreadsGivesTheSameBits) {
  BundleProblem one = noisy_problem(), three = one;
  ThreadPool alone(1), together(3);
  adjust_bundle(one, {}, alone);
  adjust_bundle(three, {}, together);
  for (size_t i = 0; i < one.points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(one.points[i][axis], three.points[i][axis]) << i;
  }
  EXPECT_EQ(one.focal_factor, three.focal_factor);
}

TEST_F(BundleAdjustmentTest, APixelThatIsNoNumberChangesNothing) {
  BundleProblem problem = noisy_problem();
  problem.observations[4].pixel.x = std::numeric_limits<double>::quiet_NaN();
  const BundleReport report = adjust_bundle(problem, {}, pool_);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(problem.cameras[1].world_to_camera.translation.x, -0.4);
}

/// Two views of one camera, and a point that one of them sees twice.
TEST_F(BundleAdjustmentTest, APointMayBeSeenTwiceByAView) {
  BundleProblem problem = exact_problem();
  Observation again = problem.observations[1];
  again.pixel.x += 0.2;
  problem.observations.push_back(again);
  const BundleReport report = adjust_bundle(problem, weak_prior(), pool_);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.end_rms, report.start_rms);
}

}  // namespace
}  // namespace aligngs
