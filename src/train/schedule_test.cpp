#include "train/schedule.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "train/view_order.h"

namespace aligngs {
namespace {

TrainingFacts room() {
  TrainingFacts f;
  f.training_views = 20;
  f.prior_depth = PriorDepthKind::kMetric;
  f.semantics = true;
  f.dense_start = true;
  f.normals_at_start = true;
  f.extent = 2;
  return f;
}

Schedule schedule_of(const TrainConfig& config, const TrainingFacts& room) { return Schedule(config, room); }

TrainConfig paper() { return make_preset(Preset::kPaper); }

/// The default preset in as many iterations as its [ref] keys count, so that these are the iterations at which things
/// happen.
TrainConfig standard() {
  TrainConfig c = make_preset(Preset::kDefault);
  c.train.iterations = c.train.reference_iterations;
  return c;
}

TEST(Schedule, SemanticSampleMovesOnWithEveryPassOverTheViews) {
  TrainConfig c = standard();
  c.semantic.pixel_share = 0.25;
  TrainingFacts f = room();
  f.training_views = 20;
  f.image_side = 320;
  const Schedule s = schedule_of(c, f);
  EXPECT_EQ(s.request(1).losses.semantic_sample.quarters, 1);
  EXPECT_EQ(s.request(1).losses.semantic_sample.square_shift, 6);
  EXPECT_EQ(s.request(20).losses.semantic_sample.phase, 0);
  EXPECT_EQ(s.request(21).losses.semantic_sample.phase, 1);
}

TEST(Schedule, PositionRateDecaysLogLinearlyToTheRunsRealEnd) {
  const Schedule s = schedule_of(standard(), room());
  EXPECT_NEAR(s.request(3500).rates.position, 1.6e-5 * 2, 1e-9);  // geometric mean of 1.6e-4 and 1.6e-6
  EXPECT_NEAR(s.request(7000).rates.position, 1.6e-6 * 2, 1e-10);
  EXPECT_NEAR(s.request(9000).rates.position, 1.6e-6 * 2, 1e-10);  // beyond the end: the end value
}

TEST(Schedule, RatesOfTheSpec) {
  const LearningRates r = schedule_of(paper(), room()).request(1).rates;
  EXPECT_FLOAT_EQ(r.sh_dc, 2.5e-3f);
  EXPECT_FLOAT_EQ(r.sh_rest, 1.25e-4f);
  EXPECT_FLOAT_EQ(r.opacity, 0.05f);
  EXPECT_FLOAT_EQ(r.scale, 5e-3f);
  EXPECT_FLOAT_EQ(r.rotation, 1e-3f);
  EXPECT_FLOAT_EQ(r.semantic, 1e-3f);
}

TEST(Schedule, PaperTurnsGuidanceOnAt1501) {
  const Schedule s = schedule_of(paper(), room());
  const LossSettings before = s.request(1500).losses, after = s.request(1501).losses;
  EXPECT_EQ(
      before.weight[Loss::kPearson] + before.weight[Loss::kNormalConsistency] + before.weight[Loss::kNormalBoundary],
      0);
  EXPECT_FLOAT_EQ(after.weight[Loss::kPearson], 0.5f);
  EXPECT_FLOAT_EQ(after.weight[Loss::kNormalConsistency], 0.05f);
  EXPECT_FLOAT_EQ(after.weight[Loss::kNormalBoundary], 0.01f);
  EXPECT_TRUE(after.paper_normals);
  EXPECT_EQ(after.weight[Loss::kLogDepth] + after.weight[Loss::kCrease] + after.weight[Loss::kPriorNormal], 0);
  EXPECT_FLOAT_EQ(after.weight[Loss::kFlatten], 100);
}

TEST(Schedule, MultiViewTermsActFromTheirShareOfTheRun) {
  TrainConfig c = make_preset(Preset::kPgsr);
  c.train.iterations = 3000;  // 1633 of 7000 are 700 of 3000, as the published 7000 of 30000
  TrainingFacts cloud = room();
  cloud.normals_at_start = false;
  const Schedule s = schedule_of(c, cloud);
  EXPECT_EQ(s.request(700).losses.weight[Loss::kMultiViewGeometric], 0);
  EXPECT_EQ(s.request(700).losses.weight[Loss::kMultiViewPhotometric], 0);
  EXPECT_FLOAT_EQ(s.request(701).losses.weight[Loss::kMultiViewGeometric], 0.03f);
  EXPECT_FLOAT_EQ(s.request(701).losses.weight[Loss::kMultiViewPhotometric], 0.15f);
  EXPECT_FLOAT_EQ(s.request(701).losses.weight[Loss::kNormalConsistency], 0.015f);
}

TEST(Schedule, MultiViewTermsWaitForNormals) {
  TrainConfig c = standard();
  c.loss.multi_view_photometric = 0.15;
  c.loss.multi_view_from = 0;
  EXPECT_GT(schedule_of(c, room()).request(1).losses.weight[Loss::kMultiViewPhotometric], 0);
  TrainingFacts cloud = room();
  cloud.normals_at_start = false;
  EXPECT_EQ(schedule_of(c, cloud).request(500).losses.weight[Loss::kMultiViewPhotometric], 0);  // loss.normal_start
  EXPECT_GT(schedule_of(c, cloud).request(501).losses.weight[Loss::kMultiViewPhotometric], 0);
}

TEST(Schedule, MultiViewTermsMayRestBetweenIterations) {
  TrainConfig c = make_preset(Preset::kPgsr);
  c.loss.multi_view_every = 5;
  const Schedule s = schedule_of(c, room());
  int active = 0;
  for (int64_t i = 4000; i < 4100; ++i) active += s.request(i).losses.weight[Loss::kMultiViewGeometric] > 0 ? 1 : 0;
  EXPECT_EQ(active, 20);
}

TEST(Schedule, PaperShDegreeGrowsEvery1000) {
  const Schedule s = schedule_of(paper(), room());
  EXPECT_EQ(s.request(999).sh_degree, 0);
  EXPECT_EQ(s.request(1000).sh_degree, 1);
  EXPECT_EQ(s.request(2000).sh_degree, 2);
  EXPECT_EQ(s.request(7000).sh_degree, 3);
}

TEST(Schedule, DefaultShDegreeDependsOnTheNumberOfViewsAndWhoMadeTheCameras) {
  TrainingFacts f = room();
  EXPECT_EQ(schedule_of(standard(), f).request(7000).sh_degree, 3);
  f.network_cameras = true;
  EXPECT_EQ(schedule_of(standard(), f).request(7000).sh_degree, 1);
  f.training_views = 31;
  EXPECT_EQ(schedule_of(standard(), f).request(7000).sh_degree, 2);
}

TEST(Schedule, DropoutRisesEvenly) {
  TrainConfig c = standard();
  c.train.opacity_dropout = 0.2;
  const Schedule s = schedule_of(c, room());
  EXPECT_NEAR(s.opacity_dropout(1), 0, 1e-4);
  EXPECT_NEAR(s.opacity_dropout(3500), 0.1, 1e-9);
  EXPECT_NEAR(s.opacity_dropout(7000), 0.2, 1e-9);
  EXPECT_EQ(s.request(7000).raster.dropout.rate, 0) << "what is drawn between the steps is whole";
}

TEST(Schedule, DropoutMayEndBeforeTheRun) {
  TrainConfig c = standard();
  c.train.opacity_dropout = 0.2;
  c.train.opacity_dropout_stop = 3500;
  const Schedule s = schedule_of(c, room());
  EXPECT_NEAR(s.opacity_dropout(3500), 0.1, 1e-9);
  EXPECT_EQ(s.opacity_dropout(3501), 0);
}

TEST(Schedule, CoarseViewsScaleWithTheRunAndEnd) {
  TrainConfig c = standard();
  EXPECT_EQ(schedule_of(c, room()).view_scale(1), 1);  // off unless asked for
  c.train.coarse_scale = 0.5;
  c.train.coarse_stop = 3000;
  c.train.iterations = 1400;  // a fifth of the reference length
  const Schedule s = schedule_of(c, room());
  EXPECT_EQ(s.view_scale(1), 0.5);
  EXPECT_EQ(s.view_scale(600), 0.5);
  EXPECT_EQ(s.view_scale(601), 1);
}

TEST(Schedule, PaperDensityControlAndOpacityResets) {
  const Schedule s = schedule_of(paper(), room());
  std::vector<int64_t> densify, reset;
  for (int64_t i = 1; i <= 7000; ++i) {
    if (s.densifies(i)) densify.push_back(i);
    if (s.resets_opacity(i)) reset.push_back(i);
  }
  EXPECT_EQ(densify.front(), 600);
  EXPECT_EQ(densify.back(), 6900);  // the one at 7000 would come after the result
  EXPECT_EQ(densify.size(), 64u);
  EXPECT_EQ(reset, (std::vector<int64_t>{3000, 6000}));
  EXPECT_EQ(s.density_rule(3000).prune_scale, 0);
  EXPECT_FLOAT_EQ(s.density_rule(3001).prune_scale, 0.2f);
  EXPECT_FLOAT_EQ(s.density_rule(600).small_scale, 0.002f);
}

std::vector<int64_t> opacity_resets(TrainConfig config, int64_t iterations) {
  config.train.iterations = iterations;
  const Schedule s = schedule_of(config, room());
  std::vector<int64_t> resets;
  for (int64_t i = 1; i <= iterations; ++i) {
    if (s.resets_opacity(i)) resets.push_back(i);
  }
  return resets;
}

TEST(Schedule, NoOpacityResetComesSoLateThatOpacityCannotRecover) {
  for (const Preset preset : {Preset::kPaper, Preset::kPgsr}) {
    const TrainConfig config = make_preset(preset);
    EXPECT_EQ(schedule_of(config, room()).opacity_recovery(), 272);  // 2 (logit 0.9 - logit 0.01) / 0.05
    EXPECT_TRUE(opacity_resets(config, 60).empty());
    EXPECT_TRUE(opacity_resets(config, 400).empty());
    EXPECT_EQ(opacity_resets(config, 600), (std::vector<int64_t>{257}));
    EXPECT_EQ(opacity_resets(config, 2000), (std::vector<int64_t>{857, 1714}));  // as the measured rows
  }
}

TEST(Schedule, RecoveryFromAResetFollowsTheRateOfOpacities) {
  TrainConfig config = paper();
  config.optimizer.opacity = 0.5;
  EXPECT_EQ(opacity_resets(config, 60), (std::vector<int64_t>{26}));
  config.optimizer.opacity = 0;
  EXPECT_TRUE(opacity_resets(config, 7000).empty());
}

TEST(Schedule, DefaultDensityControlActsBetween5And50Percent) {
  TrainingFacts f = room();
  f.training_views = 60;  // two epochs are 120 iterations, more than densify.every
  const Schedule s = schedule_of(standard(), f);
  EXPECT_FALSE(s.densifies(240));
  EXPECT_TRUE(s.densifies(360));
  EXPECT_FALSE(s.densifies(400));
  EXPECT_FALSE(s.densifies(3600));
  EXPECT_FALSE(s.request(3501).collect_density);
  EXPECT_TRUE(s.request(3500).collect_density);
  EXPECT_FALSE(s.resets_opacity(3000));
}

TEST(Schedule, OnlyADenseStartRestrictsGrowth) {
  TrainConfig config = standard();
  config.densify.residual_quantile = 0.9;
  config.densify.unsupported_min = 0.5;
  TrainingFacts f = room();
  EXPECT_FLOAT_EQ(schedule_of(config, f).density_rule(500).residual_quantile, 0.9f);
  EXPECT_FLOAT_EQ(schedule_of(config, f).density_rule(500).unsupported_min, 0.5f);
  f.dense_start = false;
  EXPECT_EQ(schedule_of(config, f).density_rule(500).residual_quantile, 0);
  EXPECT_EQ(schedule_of(config, f).density_rule(500).unsupported_min, 0);
}

TEST(Schedule, DepthWeightDecaysLogLinearly) {
  const Schedule s = schedule_of(standard(), room());
  EXPECT_NEAR(s.request(1).losses.weight[Loss::kLogDepth], 0.5, 1e-3);
  EXPECT_NEAR(s.request(3500).losses.weight[Loss::kLogDepth], 0.1, 1e-6);  // sqrt(0.5 * 0.02)
  EXPECT_NEAR(s.request(7000).losses.weight[Loss::kLogDepth], 0.02, 1e-7);
  EXPECT_EQ(s.request(1).losses.weight[Loss::kPearson], 0);
}

TEST(Schedule, DepthTermsWaitForNormalsThatTheStartLacks) {
  TrainingFacts f = room();
  f.normals_at_start = false;
  const Schedule s = schedule_of(standard(), f);
  EXPECT_EQ(s.request(500).losses.weight[Loss::kLogDepth], 0);
  EXPECT_GT(s.request(501).losses.weight[Loss::kLogDepth], 0);
}

TEST(Schedule, RelativePriorDepthGivesOnlyItsCorrelation) {
  TrainingFacts f = room();
  f.prior_depth = PriorDepthKind::kRelative;
  const LossSettings l = schedule_of(standard(), f).request(1000).losses;
  EXPECT_GT(l.weight[Loss::kPearson], 0);
  EXPECT_EQ(l.weight[Loss::kLogDepth] + l.weight[Loss::kPriorNormal] + l.weight[Loss::kCrease], 0);
  EXPECT_FALSE(schedule_of(standard(), f).aligns_prior_depth(500));
}

TEST(Schedule, WithoutPriorsTheirTermsAreOff) {
  TrainingFacts f = room();
  f.prior_depth = PriorDepthKind::kNone;
  f.semantics = false;
  const LossSettings l = schedule_of(paper(), f).request(5000).losses;
  EXPECT_EQ(l.weight[Loss::kPearson] + l.weight[Loss::kSemanticSoft] + l.weight[Loss::kSemanticHard] +
                l.weight[Loss::kNormalBoundary],
            0);
  EXPECT_FALSE(schedule_of(standard(), f).lifts_semantics(1));
}

TEST(Schedule, CouplingActsFromASeventhOfTheRunToItsLastTenth) {
  EXPECT_EQ(schedule_of(standard(), room()).request(3000).losses.coupling_strength, 0) << "off unless asked for";
  TrainConfig coupled = standard();
  coupled.semantic.coupling_strength = 0.1;
  const Schedule s = schedule_of(coupled, room());
  EXPECT_EQ(s.request(1000).losses.coupling_strength, 0);
  EXPECT_FLOAT_EQ(s.request(1001).losses.coupling_strength, 0.1f);
  EXPECT_FLOAT_EQ(s.request(6300).losses.coupling_strength, 0.1f);
  EXPECT_EQ(s.request(6301).losses.coupling_strength, 0);
  const LossSettings p = schedule_of(paper(), room()).request(1).losses;
  EXPECT_EQ(p.coupling, SemanticCoupling::kPlain);
  EXPECT_FLOAT_EQ(p.coupling_strength, 1);
}

TEST(Schedule, IterationKeysScaleWithTheRunsLength) {
  TrainConfig c = paper();
  c.train.iterations = 700;
  const Schedule s = schedule_of(c, room());
  EXPECT_EQ(s.request(150).losses.weight[Loss::kPearson], 0);
  EXPECT_GT(s.request(151).losses.weight[Loss::kPearson], 0);
  EXPECT_TRUE(s.densifies(60));
  EXPECT_TRUE(s.resets_opacity(300));
  EXPECT_EQ(s.request(100).sh_degree, 1);
}

TEST(Schedule, ExtendedRunKeepsTheOldSchedule) {
  TrainConfig c = standard();
  c.train.schedule_iterations = 7000;
  c.train.iterations = 9000;
  const Schedule extended = schedule_of(c, room()), before(standard(), room());
  EXPECT_EQ(extended.request(2000).rates.position, before.request(2000).rates.position);
  EXPECT_EQ(extended.densifies(3600), before.densifies(3600));
  EXPECT_EQ(extended.request(8000).losses.coupling_strength, 0);
}

TEST(Schedule, ObjectsAreNamedAfterTheLastStepWithBlendedProbabilities) {
  TrainConfig c = standard();
  c.semantic.object_labels = true;
  EXPECT_TRUE(schedule_of(c, room()).names_objects(c.train.iterations));
  EXPECT_FALSE(schedule_of(c, room()).names_objects(c.train.iterations - 1));
  TrainingFacts unlabelled = room();
  unlabelled.semantics = false;
  EXPECT_FALSE(schedule_of(c, unlabelled).names_objects(c.train.iterations));
  c.semantic.blend = SemanticBlend::kLogits;
  EXPECT_FALSE(schedule_of(c, room()).names_objects(c.train.iterations));
  EXPECT_FALSE(schedule_of(paper(), room()).names_objects(paper().train.iterations)) << "off";
}

TEST(Schedule, CamerasMoveBetweenTheirStartAndStopWithFallingRates) {
  TrainConfig c = standard();
  EXPECT_FALSE(schedule_of(c, room()).pose_rates(2000).active());
  c.optimizer.pose_rotation = c.optimizer.pose_translation = 3e-4;
  const Schedule s = schedule_of(c, room());
  EXPECT_FALSE(s.pose_rates(700).active());
  EXPECT_FALSE(s.pose_rates(5601).active());
  EXPECT_NEAR(s.pose_rates(701).rotation, 3e-4, 1e-6);
  EXPECT_NEAR(s.pose_rates(701).translation, 3e-4 * room().extent, 1e-6);
  EXPECT_NEAR(s.pose_rates(5600).rotation, 3e-4 * c.optimizer.pose_end, 1e-8);
}

TEST(Schedule, TheRoomIsClosedAfterTheLastStepWhereThereAreLabels) {
  TrainConfig c = standard();
  c.train.closed_room = true;
  EXPECT_TRUE(schedule_of(c, room()).closes_room(c.train.iterations));
  EXPECT_FALSE(schedule_of(c, room()).closes_room(c.train.iterations - 1));
  TrainingFacts unlabelled = room();
  unlabelled.semantics = false;
  EXPECT_FALSE(schedule_of(c, unlabelled).closes_room(c.train.iterations));
  EXPECT_FALSE(schedule_of(standard(), room()).closes_room(c.train.iterations)) << "off";
  EXPECT_FALSE(schedule_of(paper(), room()).closes_room(paper().train.iterations));
}

TEST(Schedule, PlanesAreFittedWhereDepthIsMetricAndThereAreLabels) {
  TrainConfig c = standard();
  EXPECT_FALSE(schedule_of(c, room()).fits_planes(1000)) << "off unless asked for";
  c.loss.plane_weight = 1;
  EXPECT_TRUE(schedule_of(c, room()).fits_planes(1000));
  EXPECT_FALSE(schedule_of(c, room()).fits_planes(1001));
  EXPECT_FALSE(schedule_of(c, room()).fits_planes(c.train.iterations));
  TrainingFacts unlabelled = room(), relative = room();
  unlabelled.semantics = false;
  relative.prior_depth = PriorDepthKind::kRelative;
  EXPECT_FALSE(schedule_of(c, unlabelled).fits_planes(1000));
  EXPECT_FALSE(schedule_of(c, relative).fits_planes(1000));
}

TEST(Schedule, McmcBringsNoiseThatFallsWithTheRateOfPositions) {
  TrainConfig c = standard();
  EXPECT_EQ(schedule_of(c, room()).position_noise(10), 0);
  c.densify.strategy = GrowthStrategy::kMcmc;
  const Schedule s = schedule_of(c, room());
  EXPECT_NEAR(s.position_noise(3500) / s.position_noise(7000),
              s.request(3500).rates.position / s.request(7000).rates.position, 1e-3);
  EXPECT_NEAR(s.position_noise(7000), 5e5 * static_cast<double>(s.request(7000).rates.position), 1e-3);
}

TEST(Schedule, SmallScalesAreRaisedEveryHundredthOfTheReference) {
  TrainConfig c = standard();
  c.optimizer.scale_min_pixels = 0;
  EXPECT_FALSE(schedule_of(c, room()).raises_scales(100));
  c.optimizer.scale_min_pixels = 0.7;
  EXPECT_TRUE(schedule_of(c, room()).raises_scales(100));
  EXPECT_FALSE(schedule_of(c, room()).raises_scales(150));
  EXPECT_TRUE(schedule_of(c, room()).raises_scales(7000));
}

TEST(Schedule, LiftsSemanticsBeforeTheFirstStep) {
  EXPECT_TRUE(schedule_of(standard(), room()).lifts_semantics(1));
  EXPECT_FALSE(schedule_of(standard(), room()).lifts_semantics(2));
  EXPECT_FALSE(schedule_of(paper(), room()).lifts_semantics(1));
}

TEST(Schedule, LengthsFollowTheExtent) {
  TrainingFacts f = room();
  f.extent = 0.37f * 2;
  const StepRequest a = schedule_of(standard(), room()).request(10), b = schedule_of(standard(), f).request(10);
  EXPECT_NEAR(b.rates.position / a.rates.position, 0.37, 1e-5);
  EXPECT_NEAR(b.raster.near_plane / a.raster.near_plane, 0.37, 1e-5);
  EXPECT_EQ(a.losses.weight[Loss::kFlatten], b.losses.weight[Loss::kFlatten]) << "the engine divides by the extent";
}

TEST(ViewOrder, EveryViewOncePerEpoch) {
  ViewOrder order(7, 3);
  for (int epoch = 0; epoch < 3; ++epoch) {
    std::set<int> seen;
    for (int i = 0; i < 7; ++i) seen.insert(order.next());
    EXPECT_EQ(seen.size(), 7u);
  }
}

TEST(ViewOrder, ContinuesFromItsState) {
  ViewOrder order(5, 1);
  for (int i = 0; i < 8; ++i) order.next();
  ViewOrder resumed(5, 99);
  resumed.set_state(order.state());
  for (int i = 0; i < 20; ++i) EXPECT_EQ(resumed.next(), order.next());
}

TEST(ViewOrder, RefusesAStateOfAnotherScene) {
  ViewOrder order(5, 1);
  order.next();
  EXPECT_THROW(ViewOrder(2, 1).set_state(order.state()), Error);
}

TEST(ViewOrder, NeedsAView) { EXPECT_THROW(ViewOrder(0, 1), Error); }

}  // namespace
}  // namespace aligngs
