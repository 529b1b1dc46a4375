#include "gaussians/density_control.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

GaussianModel model_with_scales(const std::vector<float>& scales, float opacity = 0.5f) {
  GaussianModel model;
  model.semantic_channels = 2;
  model.resize(scales.size());
  for (size_t i = 0; i < scales.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      model.positions[3 * i + k] = static_cast<float>(10 * i + k);
      model.log_scales[3 * i + k] = std::log(scales[i]);
    }
    model.rotations[4 * i] = 1;
    model.opacity_logits[i] = std::log(opacity / (1 - opacity));
    model.semantics[2 * i] = static_cast<float>(i);
  }
  return model;
}

DensityStatistics quiet_statistics(size_t n) {
  DensityStatistics s;
  for (std::vector<float>* v : {&s.gradient, &s.gradient_abs, &s.radius, &s.residual, &s.unsupported}) v->assign(n, 0);
  s.visible.assign(n, 1);
  s.weight.assign(n, 1);
  return s;
}

DensityRule rule_with_small_scale(float small_scale) {
  DensityRule rule;
  rule.gradient_threshold = 2e-4f;
  rule.gradient_abs_threshold = 8e-4f;
  rule.prune_opacity = 0.005f;
  rule.small_scale = small_scale;
  return rule;
}

TEST(DensityControl, KeepsEverythingWhenNothingHappened) {
  const GaussianModel model = model_with_scales({0.1f, 0.2f});
  Random random(1);
  const RestructurePlan plan = plan_density_control(model, quiet_statistics(2), rule_with_small_scale(1), random);
  ASSERT_EQ(plan.rows.size(), 2u);
  EXPECT_EQ(plan.rows[1].source, 1u);
  EXPECT_EQ(plan.rows[1].kind, RowOrigin::Kind::kKeep);
  EXPECT_EQ(plan.cloned + plan.split + plan.pruned, 0u);
}

TEST(DensityControl, ClonesSmallAndSplitsLargeByMeanGradient) {
  const GaussianModel model = model_with_scales({0.1f, 0.1f, 5.0f, 5.0f});
  DensityStatistics s = quiet_statistics(4);
  s.visible = {2, 2, 2, 2};
  s.gradient = {4.1e-4f, 3.9e-4f, 4.1e-4f, 3.9e-4f};  // means 2.05e-4 and 1.95e-4 around the threshold 2e-4
  Random random(1);
  const RestructurePlan plan = plan_density_control(model, s, rule_with_small_scale(1), random);
  EXPECT_EQ(plan.cloned, 1u);
  EXPECT_EQ(plan.split, 1u);
  ASSERT_EQ(plan.rows.size(), 6u);  // 3 kept, 1 clone, 2 children; the split parent is gone
  EXPECT_EQ(plan.rows[2].source, 3u);
  EXPECT_EQ(plan.rows[3].kind, RowOrigin::Kind::kClone);
  EXPECT_EQ(plan.rows[3].source, 0u);
  EXPECT_EQ(plan.rows[4].kind, RowOrigin::Kind::kSplit);
  EXPECT_FLOAT_EQ(plan.rows[5].shrink, 1.6f);
}

TEST(DensityControl, AbsoluteGradientSplitsOnlyLargeOnesWithALargeRadius) {
  const GaussianModel model = model_with_scales({5.0f, 5.0f, 0.1f});
  DensityStatistics s = quiet_statistics(3);
  s.gradient_abs = {1e-3f, 1e-3f, 1e-3f};
  s.radius = {21, 19, 21};
  Random random(1);
  DensityRule rule = rule_with_small_scale(1);
  EXPECT_EQ(plan_density_control(model, s, rule, random).split, 1u);
  rule.gradient_abs_threshold = 0;
  EXPECT_EQ(plan_density_control(model, s, rule, random).split, 0u);
}

TEST(DensityControl, AbsoluteSplitsAreLimitedPerCall) {
  const GaussianModel model = model_with_scales({5.0f, 5.0f, 5.0f});
  DensityStatistics s = quiet_statistics(3);
  s.gradient_abs = {1e-3f, 3e-3f, 2e-3f};
  s.radius = {30, 30, 30};
  DensityRule rule = rule_with_small_scale(1);
  rule.abs_max_splits = 1;
  Random random(1);
  const RestructurePlan plan = plan_density_control(model, s, rule, random);
  EXPECT_EQ(plan.split, 1u);
  EXPECT_EQ(plan.rows.back().source, 1u);  // the largest
}

TEST(DensityControl, RemovesTransparentAndOversizedRows) {
  GaussianModel model = model_with_scales({0.1f, 0.1f, 5.0f});
  model.opacity_logits[1] = -6;  // opacity 0.0025
  DensityRule rule = rule_with_small_scale(1);
  rule.prune_scale = 4;
  Random random(1);
  const RestructurePlan plan = plan_density_control(model, quiet_statistics(3), rule, random);
  ASSERT_EQ(plan.rows.size(), 1u);
  EXPECT_EQ(plan.rows[0].source, 0u);
  EXPECT_EQ(plan.pruned, 2u);
}

TEST(DensityControl, ChildrenOfALargeRowStayWhenTheyAreSmallEnough) {
  const GaussianModel model = model_with_scales({5.0f});
  DensityStatistics s = quiet_statistics(1);
  s.gradient = {1};
  DensityRule rule = rule_with_small_scale(1);
  rule.prune_scale = 4;  // 5 is too large, 5 / 1.6 is not
  Random random(1);
  EXPECT_EQ(plan_density_control(model, s, rule, random).rows.size(), 2u);
}

TEST(DensityControl, CapLetsTheLargestGradientsGrow) {
  const GaussianModel model = model_with_scales({0.1f, 0.1f, 0.1f});
  DensityStatistics s = quiet_statistics(3);
  s.gradient = {1, 3, 2};
  DensityRule rule = rule_with_small_scale(1);
  rule.max_gaussians = 4;
  Random random(1);
  const RestructurePlan plan = plan_density_control(model, s, rule, random);
  ASSERT_EQ(plan.rows.size(), 4u);
  EXPECT_EQ(plan.rows[3].source, 1u);
  rule.max_gaussians = 2;  // already above: nothing grows, nothing is thrown away
  EXPECT_EQ(plan_density_control(model, s, rule, random).rows.size(), 3u);
}

TEST(DensityControl, GrowsOnlyWhereTheResidualIsInTheTopDecile) {
  const GaussianModel model = model_with_scales(std::vector<float>(10, 0.1f));
  DensityStatistics s = quiet_statistics(10);
  s.gradient.assign(10, 1);
  for (size_t i = 0; i < 10; ++i) s.residual[i] = static_cast<float>(i);
  DensityRule rule = rule_with_small_scale(1);
  rule.residual_quantile = 0.9f;
  Random random(1);
  const RestructurePlan plan = plan_density_control(model, s, rule, random);
  EXPECT_EQ(plan.cloned, 1u);
  EXPECT_EQ(plan.rows.back().source, 9u);
}

TEST(DensityControl, GrowsOnlyWherePriorDepthGivesNoSupport) {
  const GaussianModel model = model_with_scales({0.1f, 0.1f});
  DensityStatistics s = quiet_statistics(2);
  s.gradient = {1, 1};
  s.unsupported = {0.2f, 0.8f};
  DensityRule rule = rule_with_small_scale(1);
  rule.unsupported_min = 0.5f;
  Random random(1);
  const RestructurePlan plan = plan_density_control(model, s, rule, random);
  EXPECT_EQ(plan.cloned, 1u);
  EXPECT_EQ(plan.rows.back().source, 1u);
}

TEST(DensityControl, UnseenRowsNeverGrow) {
  const GaussianModel model = model_with_scales({0.1f});
  DensityStatistics s = quiet_statistics(1);
  s.visible = {0};
  s.gradient = {1};
  Random random(1);
  EXPECT_EQ(plan_density_control(model, s, rule_with_small_scale(1), random).cloned, 0u);
}

TEST(DensityControl, SamplesChildrenFromTheGaussianItself) {
  GaussianModel model = model_with_scales({1.0f});
  model.log_scales = {std::log(2.0f), std::log(0.001f), std::log(0.001f)};
  model.rotations = {std::sqrt(0.5f), 0, 0, std::sqrt(0.5f)};  // x axis to y axis
  DensityStatistics s = quiet_statistics(1);
  s.gradient = {1};
  Random random(7);
  double sum_y = 0;
  for (int k = 0; k < 200; ++k) {
    const RestructurePlan plan = plan_density_control(model, s, rule_with_small_scale(1), random);
    EXPECT_LT(std::abs(plan.rows[0].offset[0]), 0.01f);
    sum_y += plan.rows[0].offset[1] * plan.rows[0].offset[1];
  }
  EXPECT_NEAR(std::sqrt(sum_y / 200), 2.0, 0.4);
}

TEST(DensityControl, SameSeedGivesTheSamePlan) {
  const GaussianModel model = model_with_scales({0.1f, 5.0f});
  DensityStatistics s = quiet_statistics(2);
  s.gradient = {1, 1};
  Random a(3), b(3);
  const RestructurePlan first = plan_density_control(model, s, rule_with_small_scale(1), a);
  const RestructurePlan second = plan_density_control(model, s, rule_with_small_scale(1), b);
  ASSERT_EQ(first.rows.size(), second.rows.size());
  for (size_t i = 0; i < first.rows.size(); ++i) EXPECT_EQ(first.rows[i].offset[0], second.rows[i].offset[0]);
}

TEST(DensityControl, RefusesStatisticsOfAnotherSize) {
  Random random(1);
  EXPECT_THROW(plan_density_control(model_with_scales({1, 1}), quiet_statistics(1), {}, random), Error);
}

TEST(DensityControl, EmptyModelGivesAnEmptyPlan) {
  Random random(1);
  EXPECT_TRUE(plan_density_control(model_with_scales({}), quiet_statistics(0), {}, random).rows.empty());
}

TEST(DensityControl, PlanKeepDropsUnflaggedRows) {
  const RestructurePlan plan = plan_keep({1, 0, 1});
  ASSERT_EQ(plan.rows.size(), 2u);
  EXPECT_EQ(plan.rows[1].source, 2u);
  EXPECT_EQ(plan.pruned, 1u);
}

}  // namespace
}  // namespace aligngs
