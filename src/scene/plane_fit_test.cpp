#include "scene/plane_fit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace aligngs {
namespace {

const std::vector<Vec3d> kSquare = {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {1, 1, 2}};

TEST(PlaneFit, GoesThroughPointsOfAPlaneAndLooksWhereItIsTold) {
  const PlaneFit up = fit_plane(kSquare, {}, {0, 0, 1}), down = fit_plane(kSquare, {}, {0.3, 0, -1});
  EXPECT_NEAR(up.normal.z, 1, 1e-12);
  EXPECT_NEAR(down.normal.z, -1, 1e-12);
  EXPECT_NEAR(up.centre.x, 0.5, 1e-12);
  EXPECT_NEAR(up.centre.z, 2, 1e-12);
}

TEST(PlaneFit, APointWithoutWeightIsNotThere) {
  std::vector<Vec3d> points = kSquare;
  points.push_back({5, 5, 9});
  const PlaneFit fit = fit_plane(points, {1, 1, 1, 1, 0}, {0, 0, 1});
  EXPECT_NEAR(fit.normal.z, 1, 1e-12);
  EXPECT_NEAR(fit.centre.y, 0.5, 1e-12);
}

TEST(PlaneFit, AHeldNormalTurnsAsTheEvidenceWeighs) {
  // A plane through the x axis, turned by 0.1 rad. Its points tell the turn with a weight of 2.
  const std::vector<Vec3d> points = {{-1, -1, -0.1}, {1, -1, -0.1}, {0, 1, 0.1}, {0, 1, 0.1}};
  const std::vector<double> weights(points.size(), 0.5);
  const auto turn = [&](double hold) {
    const Vec3d n = fit_plane(points, weights, {0, 0, 1}, hold).normal;
    return std::atan2(-n.y, n.z);
  };
  EXPECT_NEAR(turn(0), 0.1, 1e-3);
  EXPECT_NEAR(turn(2), 0.05, 1e-3);
  EXPECT_NEAR(turn(1e9), 0, 1e-6);
}

}  // namespace
}  // namespace aligngs
