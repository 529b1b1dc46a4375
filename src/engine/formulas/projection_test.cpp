#include "engine/formulas/projection.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "engine/formulas/blending.h"

namespace aligngs {
namespace {

Camera centred_camera() {
  Camera c;
  c.width = 64;
  c.height = 48;
  c.fx = c.fy = 50;
  c.cx = 32;
  c.cy = 24;
  return c;
}

GaussianShape<double> ball(const Vec3d& position, double sigma, double logit = 2) {
  return {position, {std::log(sigma), std::log(sigma), std::log(sigma)}, {}, logit};
}

Projection<double> project_in(const Camera& camera, const GaussianShape<double>& g, const RasterSettings& s = {}) {
  return project(g, make_projection_camera<double>(camera, s), s);
}

TEST(Projection, CentreOfThePictureIsThePrincipalPoint) {
  const Projection<double> p = project_in(centred_camera(), ball({0, 0, 2}, 0.1));
  ASSERT_TRUE(p.visible());
  EXPECT_DOUBLE_EQ(p.mean.x, 32);
  EXPECT_DOUBLE_EQ(p.mean.y, 24);
  EXPECT_DOUBLE_EQ(p.z, 2);
  // A ball of 0.1 at depth 2 with f = 50 px has a standard deviation of 2.5 px, plus the low-pass.
  EXPECT_NEAR(p.covariance.xx, 2.5 * 2.5 + 0.3, 1e-6);
  EXPECT_NEAR(p.covariance.xy, 0, 1e-12);
  EXPECT_NEAR(p.conic.yy, 1 / (2.5 * 2.5 + 0.3), 1e-7);
  EXPECT_NEAR(p.radius, 3 * std::sqrt(2.5 * 2.5 + 0.3), 1e-6);
}

TEST(Projection, NormalIsTheShortestAxisTurnedToTheCamera) {
  GaussianShape<double> g = ball({0.3, 0.2, 2}, 0.1);
  g.log_scale.z -= 2;
  const Projection<double> p = project_in(centred_camera(), g);
  EXPECT_EQ(p.normal_axis, 2);
  EXPECT_DOUBLE_EQ(p.normal.z, -1);
  EXPECT_DOUBLE_EQ(p.distance, 2);  // the plane z = 2
}

TEST(Projection, EqualScalesTakeTheFirstAxis) {
  EXPECT_EQ(project_in(centred_camera(), ball({0.3, 0, 2}, 0.1)).normal_axis, 0);
}

TEST(Projection, GuardBandFollowsThePrincipalPoint) {
  const RasterSettings s;
  const ProjectionCamera<double> centred = make_projection_camera<double>(centred_camera(), s);
  EXPECT_NEAR(centred.slope_x_max, 1.3 * 32 / 50, 1e-7);
  EXPECT_NEAR(centred.slope_x_min, -1.3 * 32 / 50, 1e-7);
  Camera off = centred_camera();
  off.cx = 20;  // the image reaches from -20/50 to 44/50
  const ProjectionCamera<double> c = make_projection_camera<double>(off, s);
  EXPECT_NEAR(c.slope_x_min, (-20 - 0.3 * 32) / 50, 1e-7);
  EXPECT_NEAR(c.slope_x_max, (44 + 0.3 * 32) / 50, 1e-7);
}

TEST(Projection, PixelRangeHoldsEveryPixelAboveTheThreshold) {
  Random random(3);
  const RasterSettings s;
  const Camera camera = centred_camera();
  const ProjectionCamera<double> c = make_projection_camera<double>(camera, s);
  int visible = 0, inside = 0, unused = 0;
  for (int trial = 0; trial < 300; ++trial) {
    GaussianShape<double> g;
    g.position = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(0.5, 4)};
    g.log_scale = {random.uniform(-5, 0), random.uniform(-5, 0), random.uniform(-5, 0)};
    g.rotation = {random.normal(), random.normal(), random.normal(), random.normal()};
    g.opacity_logit = random.uniform(-7, 4);
    const Projection<double> p = project(g, c, s);
    if (!p.visible() && p.status != ProjectionStatus::kOutside) continue;
    visible += p.visible();
    IntegerRect tight{camera.width, camera.height, 0, 0};
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        if (!(alpha_at(p.mean, p.conic, p.opacity, x + 0.5, y + 0.5, s).alpha > 0)) continue;
        tight = {std::min(tight.x0, x), std::min(tight.y0, y), std::max(tight.x1, x + 1), std::max(tight.y1, y + 1)};
      }
    }
    if (tight.empty()) continue;
    EXPECT_LE(p.pixels.x0, tight.x0);
    EXPECT_LE(p.pixels.y0, tight.y0);
    EXPECT_GE(p.pixels.x1, tight.x1);
    EXPECT_GE(p.pixels.y1, tight.y1);
    // Exact extents: an ellipse wholly inside the image leaves hardly a column of its range unused.
    if (p.pixels.x0 == 0 || p.pixels.y0 == 0 || p.pixels.x1 == camera.width || p.pixels.y1 == camera.height) continue;
    ++inside;
    unused += (tight.x0 - p.pixels.x0) + (p.pixels.x1 - tight.x1);
  }
  EXPECT_GT(visible, 100);
  EXPECT_GT(inside, 20);
  EXPECT_LT(unused, inside);
}

TEST(Projection, TilesCoverThePixels) {
  const IntegerRect t = tiles_of({15, 16, 33, 32});
  EXPECT_EQ(t.x0, 0);
  EXPECT_EQ(t.x1, 3);
  EXPECT_EQ(t.y0, 1);
  EXPECT_EQ(t.y1, 2);
  EXPECT_TRUE(tiles_of({5, 5, 5, 9}).empty());
}

TEST(Projection, SaysWhyItIsNotVisible) {
  const Camera camera = centred_camera();
  EXPECT_EQ(project_in(camera, ball({0, 0, -1}, 0.1)).status, ProjectionStatus::kBehind);
  EXPECT_EQ(project_in(camera, ball({0, 0, RasterSettings().near_plane}, 0.1)).status, ProjectionStatus::kBehind);
  EXPECT_EQ(project_in(camera, ball({0, 0, 2}, 0.1, -6)).status, ProjectionStatus::kTransparent);
  EXPECT_EQ(project_in(camera, ball({50, 0, 2}, 0.1)).status, ProjectionStatus::kOutside);
  EXPECT_EQ(project_in(camera, ball({std::nan(""), 0, 2}, 0.1)).status, ProjectionStatus::kNonFinite);
  EXPECT_EQ(project_in(camera, ball({0, 0, 2}, 1e200)).status, ProjectionStatus::kNonFinite);
  RasterSettings sharp;
  sharp.low_pass = 0;
  EXPECT_EQ(project_in(camera, ball({0, 0, 2}, 0), sharp).status, ProjectionStatus::kNonFinite);  // log 0
  GaussianShape<double> point = ball({0, 0, 2}, 1);
  point.log_scale = {-800, -800, -800};
  EXPECT_EQ(project_in(camera, point, sharp).status, ProjectionStatus::kDegenerate);
}

/// A wide needle in float keeps the determinant that cxx cyy - cxy^2 would lose.
TEST(Projection, NeedleKeepsItsWidthInFloat) {
  GaussianShape<double> g = ball({0.3, 0.2, 2}, 1);
  g.log_scale = {4, -6, -6};
  g.rotation = {0.92, 0.05, 0.1, 0.38};
  GaussianShape<float> f{
      g.position.cast<float>(), g.log_scale.cast<float>(), {0.92f, 0.05f, 0.1f, 0.38f}, float(g.opacity_logit)};
  const RasterSettings s;
  const Projection<double> exact = project_in(centred_camera(), g);
  const Projection<float> p = project(f, make_projection_camera<float>(centred_camera(), s), s);
  ASSERT_TRUE(p.visible());
  EXPECT_NEAR(p.conic.xx / exact.conic.xx, 1, 1e-4);
  EXPECT_NEAR(p.conic.yy / exact.conic.yy, 1, 1e-4);
}

/// Outside the guard band the Jacobian is that of its border, so the covariance no longer follows t_x / t_z.
TEST(Projection, ClampedSlopeHasNoGradient) {
  const RasterSettings s;
  const ProjectionCamera<double> c = make_projection_camera<double>(centred_camera(), s);
  ProjectionGradient<double> d;
  d.conic = {1, 0.5, -0.3};
  for (double x : {1.0, 2.5}) {  // slopes 0.5 and 1.25; the band ends at 0.832
    const GaussianShape<double> g = ball({x, 0.1, 2}, 0.6);
    const Projection<double> p = project(g, c, s);
    ASSERT_TRUE(p.visible());
    EXPECT_EQ(project_backward(g, c, p, d).position.x == 0.0, x > 2);
  }
}

}  // namespace
}  // namespace aligngs
