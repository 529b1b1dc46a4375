#include "refine/bundle_terms.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/rotation_vector.h"

namespace aligngs {
namespace {

Camera camera() {
  Camera camera;
  camera.width = 200;
  camera.height = 150;
  camera.fx = 180;
  camera.fy = 190;
  camera.cx = 103;
  camera.cy = 70;
  camera.world_to_camera = {rotation_of({0.1, -0.3, 0.2}), {0.2, -0.1, 0.4}};
  return camera;
}

BundleTerm term() {
  BundleTerm term;
  term.pixel = {110, 64};
  term.whitening = {1.5, -0.4, 0.8};
  term.log_depth = std::log(2.2);
  term.depth_sigma = 0.1;
  return term;
}

const Vec3d kPoint{0.3, -0.2, 2};

TermRows rows_at(const Camera& camera, const Vec3d& point, double log_scale) {
  TermRows rows;
  EXPECT_TRUE(linearise(term(), camera, point, log_scale, rows));
  return rows;
}

/// The camera after a small change of one number.
Camera changed(const Camera& camera, int lane, double by) {
  Lanes step;
  step[lane] = by;
  return moved_camera(camera, step);
}

constexpr double kStep = 1e-6;

TEST(BundleTerms, DerivativesByTheViewAreFiniteDifferences) {
  const TermRows rows = rows_at(camera(), kPoint, 0.05);
  ASSERT_EQ(rows.rows, 3);
  for (int lane = 0; lane < kLanes; ++lane) {
    const double scale = lane == kScaleLane ? kStep : 0;
    const TermRows more = rows_at(changed(camera(), lane, kStep), kPoint, 0.05 + scale),
                   less = rows_at(changed(camera(), lane, -kStep), kPoint, 0.05 - scale);
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(rows.by_view[r][lane], (more.residual[r] - less.residual[r]) / (2 * kStep), 1e-5)
          << "row " << r << ", lane " << lane;
    }
  }
}

TEST(BundleTerms, DerivativesByThePointAreFiniteDifferences) {
  const TermRows rows = rows_at(camera(), kPoint, 0.05);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d step{};
    step[axis] = kStep;
    const TermRows more = rows_at(camera(), kPoint + step, 0.05), less = rows_at(camera(), kPoint - step, 0.05);
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(rows.by_point[r][axis], (more.residual[r] - less.residual[r]) / (2 * kStep), 1e-5)
          << "row " << r << ", axis " << axis;
    }
  }
}

TEST(BundleTerms, TheWeightedResidualIsTheSlopeOfTheLoss) {
  const TermRows rows = rows_at(camera(), kPoint, 0.05);
  const auto cost = [](const Vec3d& point) { return term_cost(term(), {{camera()}, {point}, {0.05}, 0}); };
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d step{};
    step[axis] = kStep;
    double slope = 0;
    for (int r = 0; r < 3; ++r) slope += rows.weight[r] * rows.residual[r] * rows.by_point[r][axis];
    EXPECT_NEAR(slope, (cost(kPoint + step) - cost(kPoint - step)) / (2 * kStep), 1e-5) << axis;
  }
}

TEST(BundleTerms, WithoutPriorDepthThereAreTwoRows) {
  BundleTerm without = term();
  without.depth_sigma = 0;
  TermRows rows;
  ASSERT_TRUE(linearise(without, camera(), kPoint, 0.05, rows));
  EXPECT_EQ(rows.rows, 2);
}

TEST(BundleTerms, BehindTheCameraThereIsNoProjection) {
  TermRows rows;
  EXPECT_FALSE(linearise(term(), camera(), {0, 0, -3}, 0, rows));
  EXPECT_TRUE(std::isinf(term_cost(term(), {{camera()}, {{0, 0, -3}}, {0}, 0})));
}

}  // namespace
}  // namespace aligngs
