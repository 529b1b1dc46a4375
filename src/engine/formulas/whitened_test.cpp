// The whitened form of opacity against the conic form in double precision, and what it is for: needles in float.
#include "engine/formulas/whitened.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "engine/formulas/blending.h"

namespace aligngs {
namespace {

Camera wide_camera() {
  Camera c;
  c.width = 64;
  c.height = 48;
  c.fx = c.fy = 50;
  c.cx = 31;
  c.cy = 25;
  return c;
}

GaussianShape<double> random_shape(Random& random, double smallest) {
  GaussianShape<double> g;
  g.position = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(1.5, 3)};
  g.log_scale = {random.uniform(-3, -1), random.uniform(-3, -1), smallest};
  g.rotation = {random.normal(), random.normal(), random.normal(), random.normal()};
  g.opacity_logit = random.uniform(-2, 4);
  return g;
}

Splat splat_of(const Projection<double>& p) {
  const WhiteningFactor<double> f = whitening_factor(p);
  Splat s{};
  s.x = static_cast<float>(p.mean.x);
  s.y = static_cast<float>(p.mean.y);
  s.fxx = static_cast<float>(f.xx);
  s.fxy = static_cast<float>(f.xy);
  s.fyy = static_cast<float>(f.yy);
  s.opacity = static_cast<float>(p.opacity);
  return s;
}

TEST(Whitened, FactorTimesItsTransposeIsTheConic) {
  Random random(1);
  const RasterSettings raster;
  const auto camera = make_projection_camera<double>(wide_camera(), raster);
  for (int i = 0; i < 50; ++i) {
    const Projection<double> p = project(random_shape(random, -4), camera, raster);
    if (!p.visible()) continue;
    const WhiteningFactor<double> f = whitening_factor(p);
    EXPECT_NEAR(kTwoLn2 * f.xx * f.xx, p.conic.xx, 1e-12 * p.conic.xx);
    EXPECT_NEAR(kTwoLn2 * f.xx * f.xy, p.conic.xy, 1e-12 * (p.conic.xx + p.conic.yy));
    EXPECT_NEAR(kTwoLn2 * (f.xy * f.xy + f.yy * f.yy), p.conic.yy, 1e-10 * (p.conic.xx + p.conic.yy));
  }
}

TEST(Whitened, AlphaAndSlopeAreThoseOfTheConicForm) {
  Random random(2);
  RasterSettings raster;
  const auto camera = make_projection_camera<double>(wide_camera(), raster);
  int taken = 0;
  for (int i = 0; i < 400; ++i) {
    raster.smooth_cutoff = i % 2 == 0;
    const Projection<double> p = project(random_shape(random, -3), camera, raster);
    if (!p.visible()) continue;
    const double x = p.mean.x + random.uniform(-6, 6), y = p.mean.y + random.uniform(-6, 6);
    const AlphaSample<double> want = alpha_at(p.mean, p.conic, p.opacity, x, y, raster);
    const WhitenedAlpha got = whitened_alpha(splat_of(p), static_cast<float>(x), static_cast<float>(y), raster);
    EXPECT_NEAR(got.alpha, want.alpha, 2e-5);
    // d alpha / d power = slope * raw opacity.
    EXPECT_NEAR(got.slope, want.slope * p.opacity * want.falloff, 1e-4);
    taken += got.wanted ? 1 : 0;
  }
  EXPECT_GT(taken, 100);
}

TEST(Whitened, AboveTheClampAlphaIsConstant) {
  const RasterSettings raster;
  Splat s{};
  s.fxx = s.fyy = 0.1f;
  s.opacity = 0.999f;
  const WhitenedAlpha a = whitened_alpha(s, 0, 0, raster);
  EXPECT_EQ(a.alpha, raster.alpha_max);
  EXPECT_EQ(a.slope, 0.0f);
}

TEST(Whitened, OfANeedleTheExponentKeepsItsDigits) {
  // A conic with eigenvalues 1e4 and 1e-2, turned by 0.7: along the needle the terms of d^T A d are a million times
  // their sum.
  const double c = std::cos(0.7), s = std::sin(0.7), thin = 1e4, thick = 1e-2;
  Projection<double> p;
  p.conic = {c * c * thick + s * s * thin, c * s * (thick - thin), s * s * thick + c * c * thin};
  p.covariance = {c * c / thick + s * s / thin, c * s * (1 / thick - 1 / thin), s * s / thick + c * c / thin};
  p.opacity = 1;
  const double along = 8;  // pixels: exp(-0.32)
  const Splat needle = splat_of(p);
  const float dx = static_cast<float>(along * c), dy = static_cast<float>(along * s);
  const double want = alpha_at<double>({0, 0}, p.conic, 1, dx, dy, {}).alpha;
  EXPECT_NEAR(whitened_alpha(needle, dx, dy, {}).alpha, want, 0.01 * want);
}

/// Both ways from gradients of single pixels to the parameters.
TEST(Whitened, MomentsGiveTheGradientsOfTheConicForm) {
  Random random(3);
  const RasterSettings raster;
  const auto camera = make_projection_camera<double>(wide_camera(), raster);
  int compared = 0;
  for (int i = 0; i < 20; ++i) {
    const GaussianShape<double> g = random_shape(random, -4);
    const Projection<double> p = project(g, camera, raster);
    if (!p.visible()) continue;
    const WhiteningFactor<double> f = whitening_factor(p);
    ProjectionGradient<double> conic;
    WhitenedMoments<double> m;
    for (int k = 0; k < 30; ++k) {
      const double x = p.mean.x + random.uniform(-3, 3), y = p.mean.y + random.uniform(-3, 3);
      const AlphaSample<double> a = alpha_at(p.mean, p.conic, p.opacity, x, y, raster);
      const double dalpha = random.uniform(-1, 1);
      alpha_backward(a, p.conic, p.opacity, dalpha, conic);
      add_moment(dalpha * a.slope * p.opacity * a.falloff, f.xx * a.dx + f.xy * a.dy, f.yy * a.dy, m);
    }
    conic.normal = {0.3, -0.2, 0.5};
    conic.distance = 0.7;
    CovarianceGradient<double> d;
    d.mean = whitened_mean_gradient(f, m.p, m.r);
    d.covariance = whitened_covariance_gradient(f, m.pp, m.pr, m.rr);
    d.opacity = m.one / p.opacity;
    d.normal = conic.normal;
    d.distance = conic.distance;
    const ShapeGradient<double> want = project_backward(g, camera, p, conic), got = project_backward(g, camera, p, d);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(got.position[k], want.position[k], 1e-9 * (1 + norm(want.position)));
      EXPECT_NEAR(got.log_scale[k], want.log_scale[k], 1e-9 * (1 + norm(want.log_scale)));
    }
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(got.rotation[k], want.rotation[k], 1e-8 * (1 + norm(want.log_scale)));
    EXPECT_NEAR(got.opacity_logit, want.opacity_logit, 1e-10);
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

}  // namespace
}  // namespace aligngs
