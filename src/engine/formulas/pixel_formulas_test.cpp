// Plane depth, colour, Adam and the terms of the Gaussians' shape.
#include <gtest/gtest.h>

#include "engine/formulas/adam.h"
#include "engine/formulas/color.h"
#include "engine/formulas/plane_depth.h"
#include "engine/formulas/shape_terms.h"

namespace aligngs {
namespace {

TEST(PlaneDepth, AlphaCancels) {
  const Vec3d n = normalized(Vec3d{0.2, 0.1, -1}), ray{0.3, -0.1, 1};
  const double d = 1.7;
  for (double a : {1.0, 0.4}) {
    EXPECT_NEAR(plane_depth(n * a, d * a, a, ray).z, d / -dot(n, ray), 1e-12);
    EXPECT_NEAR(plane_depth_paper(n * a, d * a, ray).z, d / -dot(n, ray), 1e-6);
  }
}

TEST(PlaneDepth, DerivativesMatchDifferences) {
  const Vec3d ray{0.3, -0.1, 1};
  Vec3d n{0.15, 0.2, -0.7};
  const double h = 1e-6, d = 1.3, a = 0.8;
  const PlaneDepth<double> p = plane_depth(n, d, a, ray), q = plane_depth_paper(n, d, ray);
  EXPECT_NEAR((plane_depth(n, d + h, a, ray).z - plane_depth(n, d - h, a, ray).z) / (2 * h), p.dz_ddistance, 1e-8);
  for (int k = 0; k < 3; ++k) {
    const double start = n[k];
    n[k] = start + h;
    const double up = plane_depth(n, d, a, ray).z, up_paper = plane_depth_paper(n, d, ray).z;
    n[k] = start - h;
    const double down = plane_depth(n, d, a, ray).z, down_paper = plane_depth_paper(n, d, ray).z;
    n[k] = start;
    EXPECT_NEAR((up - down) / (2 * h), p.dz_dnormal[k], 1e-7);
    EXPECT_NEAR((up_paper - down_paper) / (2 * h), q.dz_dnormal[k], 1e-7);
  }
}

TEST(PlaneDepth, GrazingPlaneIsHeldBackWithoutGradientOfTheNormal) {
  const PlaneDepth<double> p = plane_depth(Vec3d{1, 0, -0.01}, 1.0, 1.0, Vec3d{0, 0, 1});
  EXPECT_DOUBLE_EQ(p.z, 10);  // 1 / 0.1
  EXPECT_EQ(norm(p.dz_dnormal), 0);
  EXPECT_DOUBLE_EQ(p.dz_ddistance, 10);
}

TEST(PlaneDepth, NothingThereIsZero) {
  const PlaneDepth<double> p = plane_depth(Vec3d{}, 0.0, 0.0, Vec3d{0, 0, 1});
  EXPECT_EQ(p.z, 0);
  EXPECT_EQ(p.dz_ddistance, 0);
}

TEST(PlaneDepth, ValidNearTheExpectedDepthOfCoveredPixels) {
  EXPECT_TRUE(plane_depth_valid(2.0, 0.8, 0.8 * 2.2, kPlaneAlphaLoss));
  EXPECT_FALSE(plane_depth_valid(2.0, 0.8, 0.8 * 2.4, kPlaneAlphaLoss));
  EXPECT_FALSE(plane_depth_valid(2.0, 0.8, 0.8 * 2.0, kPlaneAlphaFusion));
  EXPECT_FALSE(plane_depth_valid(std::nan(""), 0.8, 0.8 * 2.0, kPlaneAlphaLoss));
}

TEST(Color, ConstantTermIsTheColor) {
  double sh[48] = {};
  sh[0] = (0.9 - 0.5) / kSh0;
  sh[1] = -5;
  const Vec3d c = sh_color(0, Vec3d{0, 0, 1}, sh);
  EXPECT_NEAR(c.x, 0.9, 1e-12);
  EXPECT_EQ(c.y, 0);  // clamped
  EXPECT_EQ(c.z, 0.5);
}

TEST(Color, GradientMatchesDifferences) {
  double sh[48];
  for (int k = 0; k < 48; ++k) sh[k] = 0.3 * std::sin(1.3 * k);
  sh[1] = -9;  // green is clamped
  const Vec3d centre{0.4, -0.2, 0.1}, weight{0.7, 1.1, -0.4};
  Vec3d position{1.2, 0.5, 2.0};
  const auto loss = [&](int degree) { return dot(weight, sh_color(degree, view_direction(position, centre), sh)); };
  const double h = 1e-6;
  for (int degree = 0; degree <= 3; ++degree) {
    double dsh[48] = {};
    const Vec3d color = sh_color(degree, view_direction(position, centre), sh);
    const Vec3d dposition = sh_color_backward(degree, position, centre, sh, color, weight, dsh);
    for (int k = 0; k < 3; ++k) {
      const double start = position[k];
      position[k] = start + h;
      const double up = loss(degree);
      position[k] = start - h;
      const double down = loss(degree);
      position[k] = start;
      EXPECT_NEAR((up - down) / (2 * h), dposition[k], 1e-8);
    }
    for (int k = 0; k < 48; ++k) {
      const double start = sh[k];
      sh[k] = start + h;
      const double up = loss(degree);
      sh[k] = start - h;
      const double down = loss(degree);
      sh[k] = start;
      EXPECT_NEAR((up - down) / (2 * h), dsh[k], 1e-8);
    }
  }
}

TEST(Color, CameraInTheGaussianHasNoDirection) {
  double sh[48] = {}, dsh[48] = {};
  sh[5] = 1;
  const Vec3d p{1, 2, 3};
  const Vec3d color = sh_color(3, view_direction(p, p), sh);
  EXPECT_EQ(norm(sh_color_backward(3, p, p, sh, color, Vec3d{1, 1, 1}, dsh)), 0);
}

TEST(Adam, FirstStepsFollowTheDefinition) {
  AdamSettings settings;
  double parameter = 1, m = 0, v = 0;
  adam_update(make_adam_step<double>(settings, 0.01, 1), 0.5, parameter, m, v);
  EXPECT_NEAR(parameter, 1 - 0.01, 1e-9);  // the first step has the length of the rate
  adam_update(make_adam_step<double>(settings, 0.01, 2), -0.25, parameter, m, v);
  const double b1 = settings.beta1, b2 = settings.beta2;
  const double m2 = b1 * (1 - b1) * 0.5 - (1 - b1) * 0.25, v2 = b2 * (1 - b2) * 0.25 + (1 - b2) * 0.0625;
  EXPECT_NEAR(parameter, 0.99 - 0.01 * (m2 / (1 - b1 * b1)) / std::sqrt(v2 / (1 - b2 * b2)), 1e-9);
}

TEST(Adam, NoGradientNoStep) {
  float parameter = 1, m = 0, v = 0;
  adam_update(make_adam_step<float>(AdamSettings(), 0.01, 1), 0.0f, parameter, m, v);
  EXPECT_EQ(parameter, 1.0f);
}

TEST(Adam, RowsAreCorrectedByTheirOwnUpdates) {
  const AdamSettings settings;
  const AdamStep<float> late = make_adam_step<float>(settings, 0.02, 4000);
  const AdamRowSteps steps = make_adam_row_steps(settings, 0.02f, 4000);
  for (const int count : {1, 2, 7, 40, 1000, 4000}) {
    const AdamStep<float> got = steps.at(static_cast<float>(count));
    const AdamStep<double> want = make_adam_step<double>(settings, 0.02, count);
    EXPECT_NEAR(got.step_size, want.step_size, 1e-6 * want.step_size) << count;
    EXPECT_NEAR(got.second_correction, want.second_correction, 1e-6 * want.second_correction) << count;
    EXPECT_EQ(got.beta1, late.beta1);
  }
  EXPECT_EQ(steps.at(1e7f).step_size, steps.at(4000).step_size);  // not more updates than steps
  EXPECT_EQ(steps.at(NAN).step_size, steps.at(1).step_size);
}

TEST(Adam, FirstUpdateOfARowThatWaitedMovesItByTheRate) {
  const AdamRowSteps steps = make_adam_row_steps(AdamSettings(), 0.01f, 1000);
  float parameter = 0, m = 0, v = 0;
  adam_update(steps.at(1), 0.3f, parameter, m, v);
  EXPECT_NEAR(parameter, -0.01, 1e-6);
}

TEST(Adam, FloatAgreesWithDoubleAtLargeStepNumbers) {
  float pf = 0, mf = 0, vf = 0;
  double pd = 0, md = 0, vd = 0;
  for (int t = 1; t < 3000; ++t) {
    const double g = std::sin(0.1 * t) + 0.3;
    adam_update(make_adam_step<float>(AdamSettings(), 1e-3, t), float(g), pf, mf, vf);
    adam_update(make_adam_step<double>(AdamSettings(), 1e-3, t), g, pd, md, vd);
  }
  EXPECT_NEAR(pf, pd, 1e-4 * std::abs(pd));
}

TEST(ShapeTerms, SmallestAxisLowestIndexOnTies) {
  EXPECT_EQ(smallest_axis(Vec3d{1, 1, 1}), 0);
  EXPECT_EQ(smallest_axis(Vec3d{2, 1, 1}), 1);
  EXPECT_EQ(smallest_axis(Vec3d{2, 1, 0}), 2);
}

TEST(ShapeTerms, LimitsFlattenAndShorten) {
  ShapeLimits limits;
  limits.flat_ratio_max = 0.2f;
  limits.aspect_max = 6;
  limits.scale_max = 3;
  Vec3d s{std::log(10.0), std::log(0.1), std::log(0.05)};
  apply_shape_limits(limits, s);
  EXPECT_NEAR(std::exp(s.x), 0.6, 1e-6);   // 6 times the middle
  EXPECT_NEAR(std::exp(s.y), 0.1, 1e-12);  // the middle stays
  EXPECT_NEAR(std::exp(s.z), 0.02, 1e-7);  // a fifth of the middle
  Vec3d ball{0.0, 0.0, 0.0};
  apply_shape_limits(limits, ball);
  EXPECT_NEAR(std::exp(ball.x), 0.2, 1e-6);  // of equals, the first is the normal
  EXPECT_EQ(ball.y, 0);
  EXPECT_EQ(ball.z, 0);
  Vec3d free{5, 1, 0};
  apply_shape_limits(ShapeLimits(), free);
  EXPECT_EQ(free.x, 5);
}

TEST(ShapeTerms, AFloorRaisesTheTwoLargerScales) {
  Vec3d s{-3, -9, -5};
  raise_larger_scales(-4.0, s);
  EXPECT_EQ(s.x, -3);
  EXPECT_EQ(s.y, -9);
  EXPECT_EQ(s.z, -4);
}

}  // namespace
}  // namespace aligngs
