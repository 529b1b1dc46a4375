#include "gaussians/mcmc_growth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gaussians/restructure.h"

namespace aligngs {
namespace {

GaussianModel model_of(const std::vector<float>& opacities) {
  GaussianModel model;
  model.resize(opacities.size());
  for (size_t i = 0; i < opacities.size(); ++i) {
    model.opacity_logits[i] = std::log(opacities[i] / (1 - opacities[i]));
    model.positions[3 * i] = static_cast<float>(i);
    model.rotations[4 * i] = 1;
  }
  return model;
}

float opacity_of_row(const GaussianModel& model, size_t i) { return 1 / (1 + std::exp(-model.opacity_logits[i])); }

TEST(McmcGrowth, OneCopyIsTheGaussianItself) {
  const SharedShape shape = shared_shape(0.7, 1);
  EXPECT_NEAR(shape.opacity, 0.7, 1e-12);
  EXPECT_NEAR(shape.shrink, 1, 1e-12);
}

TEST(McmcGrowth, CopiesTogetherAreAsOpaqueInTheMiddleAndSpreadAsMuch) {
  for (const int copies : {2, 5, 40}) {
    const SharedShape shape = shared_shape(0.9, copies);
    EXPECT_NEAR(1 - std::pow(1 - shape.opacity, copies), 0.9, 1e-12);
    // Integral over a line: of one Gaussian 0.9 s sqrt(2 pi), of the copies blended over each other.
    const double s = 1 / shape.shrink;
    double one = 0, all = 0;
    for (double x = -12; x < 12; x += 0.001) {
      one += 0.9 * std::exp(-0.5 * x * x);
      all += 1 - std::pow(1 - shape.opacity * std::exp(-0.5 * x * x / (s * s)), copies);
    }
    EXPECT_NEAR(all / one, 1, 1e-3) << copies;
  }
}

TEST(McmcGrowth, DeadRowsMoveToLivingOnesAndTheNumberStaysAtTheCap) {
  const GaussianModel model = model_of({0.8f, 0.001f, 0.3f, 0.002f});
  Random random(3);
  McmcRule rule{.dead_opacity = 0.005f, .growth = 1.05};
  rule.max_gaussians = 4;
  const RestructurePlan plan = plan_mcmc_growth(model, rule, random);
  ASSERT_EQ(plan.rows.size(), 4u);
  EXPECT_EQ(plan.pruned, 2u);
  EXPECT_EQ(plan.cloned, 2u);
  for (const RowOrigin& row : plan.rows) EXPECT_TRUE(row.source == 0 || row.source == 2);
}

TEST(McmcGrowth, TheNumberRisesByAShareUntilTheCap) {
  const GaussianModel model = model_of(std::vector<float>(100, 0.5f));
  McmcRule rule{.dead_opacity = 0.005f, .growth = 1.05};
  rule.max_gaussians = 1000;
  Random random(3);
  EXPECT_EQ(plan_mcmc_growth(model, rule, random).rows.size(), 105u);
  rule.max_gaussians = 102;
  EXPECT_EQ(plan_mcmc_growth(model, rule, random).rows.size(), 102u);
  rule.max_gaussians = 0;
  EXPECT_EQ(plan_mcmc_growth(model, rule, random).rows.size(), 100u);
}

TEST(McmcGrowth, ARowAndItsCopiesShareTheirOpacity) {
  GaussianModel model = model_of({0.9f, 0.001f});
  McmcRule rule{.dead_opacity = 0.005f, .growth = 1.05};
  Random random(1);
  const RestructurePlan plan = plan_mcmc_growth(model, rule, random);
  restructure_model(plan, model);
  ASSERT_EQ(model.size(), 2u);
  EXPECT_NEAR(opacity_of_row(model, 0), 1 - std::sqrt(0.1), 1e-5);
  EXPECT_EQ(model.opacity_logits[0], model.opacity_logits[1]);
  EXPECT_NEAR(model.log_scales[0], -std::log(shared_shape(0.9, 2).shrink), 1e-5);
  std::vector<float> moments = {1, 2};
  restructure_rows(plan, 1, moments);
  EXPECT_EQ(moments, (std::vector<float>{0, 0}));
}

TEST(McmcGrowth, OpaqueRowsAreDrawnInProportion) {
  GaussianModel model = model_of({0.9f, 0.1f});
  const float dead = model_of({0.001f}).opacity_logits[0];
  model.resize(2002);
  for (size_t i = 2; i < model.size(); ++i) model.opacity_logits[i] = dead;
  Random random(5);
  size_t first = 0;
  const McmcRule rule{.dead_opacity = 0.005f};
  for (const RowOrigin& row : plan_mcmc_growth(model, rule, random).rows) first += row.source == 0;
  EXPECT_NEAR(static_cast<double>(first) / 2002, 0.9, 0.03);
}

TEST(McmcGrowth, WithoutLivingRowsEverythingStays) {
  const GaussianModel model = model_of({0.001f, 0.002f});
  Random random(1);
  const RestructurePlan plan = plan_mcmc_growth(model, {.dead_opacity = 0.005f}, random);
  ASSERT_EQ(plan.rows.size(), 2u);
  EXPECT_EQ(plan.rows[0].kind, RowOrigin::Kind::kKeep);
}

}  // namespace
}  // namespace aligngs
