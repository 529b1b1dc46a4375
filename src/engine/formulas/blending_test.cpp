#include "engine/formulas/blending.h"

#include <gtest/gtest.h>

#include <vector>

namespace aligngs {
namespace {

const Vec2d kMean{3.2, 4.1};
const Symmetric2<double> kConic{0.4, 0.1, 0.3};

TEST(Blending, AlphaIsOpacityTimesTheGaussian) {
  const AlphaSample<double> s = alpha_at(kMean, kConic, 0.7, 4.5, 3.5, RasterSettings());
  const double dx = 1.3, dy = -0.6;
  EXPECT_NEAR(s.alpha, 0.7 * std::exp(-0.5 * (0.4 * dx * dx + 0.3 * dy * dy) - 0.1 * dx * dy), 1e-12);
  EXPECT_EQ(s.slope, 1.0);
}

TEST(Blending, AlphaIsClampedWithoutGradient) {
  const AlphaSample<double> s = alpha_at({3, 4}, kConic, 1.0, 3.0, 4.0, RasterSettings());
  EXPECT_DOUBLE_EQ(s.alpha, double(0.99f));
  EXPECT_EQ(s.slope, 0.0);
}

TEST(Blending, AlphaBelowTheThresholdIsNothing) {
  EXPECT_EQ(alpha_at(kMean, kConic, 0.0039, 3.2, 4.1, RasterSettings()).alpha, 0.0);
  EXPECT_GT(alpha_at(kMean, kConic, 0.0040, 3.2, 4.1, RasterSettings()).alpha, 0.0);
  EXPECT_EQ(alpha_at(kMean, kConic, std::nan(""), 3.2, 4.1, RasterSettings()).alpha, 0.0);
}

TEST(Blending, ImproperConicIsSkipped) {
  EXPECT_EQ(alpha_at(kMean, {0.1, 0.5, 0.1}, 0.5, 5.2, 2.1, RasterSettings()).alpha, 0.0);
}

TEST(Blending, SmoothCutoffIsContinuousWithItsSlope) {
  RasterSettings s;
  s.smooth_cutoff = true;
  const double step = 1e-7;
  for (double raw : {1.0, 1.2, 1.6, 1.99, 2.0, 2.5}) {
    const double o = raw * s.alpha_min;
    const auto alpha = [&](double opacity) { return alpha_at({3, 4}, kConic, opacity, 3.0, 4.0, s).alpha; };
    const double slope = (alpha(o + step) - alpha(o - step)) / (2 * step);
    EXPECT_NEAR(alpha_at({3, 4}, kConic, o, 3.0, 4.0, s).slope, slope, 2e-4) << raw;
  }
  EXPECT_NEAR(alpha_at({3, 4}, kConic, 1.0001 * s.alpha_min, 3.0, 4.0, s).alpha, 0.0, 1e-9);
}

TEST(Blending, AlphaGradientMatchesDifferences) {
  RasterSettings settings;
  settings.smooth_cutoff = true;
  const double h = 1e-6;
  for (double opacity : {0.8, 0.008}) {  // 0.008: inside the ramp
    double p[6] = {kMean.x, kMean.y, kConic.xx, kConic.xy, kConic.yy, opacity};
    const auto sample = [&] { return alpha_at<double>({p[0], p[1]}, {p[2], p[3], p[4]}, p[5], 3.5, 4.5, settings); };
    ProjectionGradient<double> g;
    const AlphaSample<double> s = sample();
    const Vec2d mean = alpha_backward(s, {p[2], p[3], p[4]}, p[5], 1.0, g);
    EXPECT_EQ(mean.x, g.mean.x);
    const double analytic[6] = {g.mean.x, g.mean.y, g.conic.xx, g.conic.xy, g.conic.yy, g.opacity};
    for (int k = 0; k < 6; ++k) {
      const double start = p[k];
      p[k] = start + h;
      const double up = sample().alpha;
      p[k] = start - h;
      const double down = sample().alpha;
      p[k] = start;
      EXPECT_NEAR((up - down) / (2 * h), analytic[k], 1e-6) << k;
    }
  }
}

TEST(Blending, StopsBeforeTransmittanceVanishes) {
  double transmittance = 0.005, weight = -1;
  EXPECT_FALSE(blend_step(0.99, 1e-4, transmittance, weight));
  EXPECT_EQ(transmittance, 0.005);  // not blended
  EXPECT_TRUE(blend_step(0.5, 1e-4, transmittance, weight));
  EXPECT_DOUBLE_EQ(weight, 0.0025);
}

/// dL/dalpha of a pixel by differences against the front-to-back sweep, behind nearly opaque layers too.
TEST(Blending, SweepMatchesDifferences) {
  std::vector<double> alpha = {0.3, 0.99, 0.95, 0.6, 0.02, 0.9};
  const std::vector<double> q = {0.4, -1.2, 0.7, 2.0, -0.3, 1.1};
  const double background = 0.8;
  const auto loss = [&] {
    double t = 1, sum = 0;
    for (size_t k = 0; k < alpha.size(); ++k) sum += alpha[k] * t * q[k], t *= 1 - alpha[k];
    return sum + t * background;
  };
  AlphaSweep<double> sweep;
  sweep.total = loss();
  double t = 1;
  for (size_t k = 0; k < alpha.size(); ++k) {
    const double g = sweep.next(alpha[k], t, alpha[k] * t, q[k]);
    t *= 1 - alpha[k];
    const double start = alpha[k], h = 1e-6;
    alpha[k] = start + h;
    const double up = loss();
    alpha[k] = start - h;
    const double down = loss();
    alpha[k] = start;
    EXPECT_NEAR((up - down) / (2 * h), g, 1e-8) << k;
  }
}

/// In float the total is summed from the same q. The last of many layers then keeps a gradient that is right relative
/// to its own tiny transmittance.
TEST(Blending, SweepOfManyLayersDoesNotDriftInFloat) {
  const float alpha = 0.4f, q = 0.37f;
  AlphaSweep<float> sweep;
  float t = 1;
  std::vector<float> transmittance;
  while (t * (1 - alpha) > 1e-4f) {
    transmittance.push_back(t);
    sweep.total += alpha * t * q;
    t *= 1 - alpha;
  }
  for (float before : transmittance) {
    // All layers alike and no background: dL/dalpha_j = T_j q - q (T_{j+1} - T_end) / (1 - alpha) = q T_end / 0.6.
    EXPECT_NEAR(sweep.next(alpha, before, alpha * before, q), q * t / (1 - alpha), 1e-6f);
  }
}

TEST(Blending, IntersectionDepthIsClampedAroundTheCentre) {
  Projection<double> p;
  p.z = 2;
  p.z_min = 1.7;
  p.z_max = 2.3;
  p.normal = normalized(Vec3d{0.5, 0, -1});
  p.distance = 2 / norm(Vec3d{0.5, 0, -1});
  EXPECT_NEAR(intersection_depth(p, {0, 0, 1}), 2.0, 1e-12);
  EXPECT_NEAR(intersection_depth(p, {0.1, 0, 1}), 2.0 / 0.95, 1e-12);
  EXPECT_EQ(intersection_depth(p, {1.0, 0, 1}), 2.3);
  EXPECT_EQ(intersection_depth(p, {-1.0, 0, 1}), 1.7);
  EXPECT_EQ(intersection_depth(p, {1.95, 0, 1}), 2.0);  // grazing: the centre
  EXPECT_EQ(intersection_depth(p, {5.0, 0, 1}), 2.0);   // from behind
}

TEST(Blending, PriorSupport) {
  EXPECT_FALSE(prior_unsupported(2.0, 2.09));
  EXPECT_TRUE(prior_unsupported(2.0, 2.11));
  EXPECT_TRUE(prior_unsupported(0.0, 2.0));
  EXPECT_TRUE(prior_unsupported(std::nan(""), 2.0));
  EXPECT_TRUE(prior_unsupported(HUGE_VAL, 2.0));
}

}  // namespace
}  // namespace aligngs
