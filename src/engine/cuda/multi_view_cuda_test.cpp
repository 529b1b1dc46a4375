// The multi-view terms against the CPU's: values, gradients and degenerate cases, on maps and in whole steps.
#include "engine/cuda/multi_view.h"

#include <gtest/gtest.h>

#include <limits>

#include "engine/cuda/cuda_engine.h"
#include "engine/cuda/testing/maps.h"
#include "engine/losses/testing/two_view_maps.h"
#include "engine/testing/two_view_scene.h"

namespace aligngs::cuda {
namespace {

using namespace cpu::testing_scene;
using cpu::testing_scene::RandomSceneOptions;
using testing_maps::TwoViewFixture;

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

class CudaMultiView : public DeviceTest {
 protected:
  static TwoViewFixture fixture(float geometric = 0.7f, float photometric = 0.4f) {
    TwoViewFixture f(60, 46);
    f.settings.weight[Loss::kMultiViewGeometric] = geometric;
    f.settings.weight[Loss::kMultiViewPhotometric] = photometric;
    return f;
  }
  static TestNeighbour neighbour(const TwoViewFixture& f) {
    return {&f.other, {f.other_depth.begin(), f.other_depth.end()}, f.seed};
  }
  MapLossResult on_device(const TwoViewFixture& f) { return losses_on_device(context(), f, neighbour(f)); }
  void compare(const TwoViewFixture& f) {
    expect_same_losses(on_device(f), losses_on_cpu(f, neighbour(f)), CudaTolerance().two_view_flips);
  }
  void expect_no_terms(const TwoViewFixture& f) {
    const MapLossResult r = on_device(f);
    EXPECT_EQ(r.terms.total, 0);
    EXPECT_EQ(largest(r.gradients.normal) + largest(r.gradients.distance), 0);
    expect_same_losses(r, losses_on_cpu(f, neighbour(f)));
  }
};

TEST_F(CudaMultiView, EachTermAgreesWithTheCpu) {
  for (const auto& [geometric, photometric] : {std::pair{0.7f, 0.0f}, std::pair{0.0f, 0.4f}, std::pair{0.7f, 0.4f}}) {
    const TwoViewFixture f = fixture(geometric, photometric);
    const MapLossResult cpu = losses_on_cpu(f, neighbour(f));
    EXPECT_EQ(cpu.terms[Loss::kMultiViewGeometric] > 0, geometric > 0)
        << "the fixture must give the term something to do";
    EXPECT_EQ(cpu.terms[Loss::kMultiViewPhotometric] > 0, photometric > 0);
    expect_same_losses(on_device(f), cpu, CudaTolerance().two_view_flips);
  }
}

TEST_F(CudaMultiView, BesideEveryOtherTerm) {
  TwoViewFixture f = fixture();
  f.settings.weight[Loss::kL1] = 0.8f;
  f.settings.weight[Loss::kSsim] = 0.2f;
  f.settings.weight[Loss::kLogDepth] = f.settings.weight[Loss::kPearson] = 0.5f;
  f.settings.weight[Loss::kNormalConsistency] = f.settings.weight[Loss::kCrease] =
      f.settings.weight[Loss::kPriorNormal] = 0.3f;
  compare(f);
  f.settings.paper_normals = true;
  compare(f);
}

TEST_F(CudaMultiView, MasksAndMissingDepthsHaveNoPart) {
  TwoViewFixture f = fixture();
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 1.0f);
  for (int y = 5; y < 20; ++y) {
    for (int x = 10; x < 30; ++x) f.view.data.mask.at(x, y) = 0;
  }
  for (size_t i = 0; i < f.other_depth.size(); i += 37) f.other_depth[i] = 0;
  for (size_t i = 0; i < f.pixels(); i += 11) f.maps.expected[i] *= 1.3;  // not tight
  compare(f);
}

TEST_F(CudaMultiView, WithoutANeighbourTheTermsDoNotAct) {
  const TwoViewFixture f = fixture();
  const MapLossResult r = losses_on_device(context(), f);
  EXPECT_EQ(r.terms.total, 0);
  expect_same_losses(r, losses_on_cpu(f));
}

TEST_F(CudaMultiView, ANeighbourThatSeesNothing) {
  TwoViewFixture f = fixture();
  std::fill(f.other_depth.begin(), f.other_depth.end(), 0.0);
  expect_no_terms(f);
}

TEST_F(CudaMultiView, ANeighbourThatLooksAway) {
  TwoViewFixture f = fixture();
  f.other.data.camera.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{0, 0, 1, 0}));
  expect_no_terms(f);
}

TEST_F(CudaMultiView, FewerThanOnePixelInAHundredIsNone) {
  TwoViewFixture f = fixture();
  for (size_t i = 20; i < f.pixels(); ++i) f.maps.alpha[i] = 0;
  expect_no_terms(f);
}

TEST_F(CudaMultiView, FlatPhotosAreNoPatches) {
  TwoViewFixture f = fixture(0.0f, 0.4f);
  std::fill(f.other.data.color.data.begin(), f.other.data.color.data.end(), 0.5f);
  expect_no_terms(f);
}

TEST_F(CudaMultiView, PhotosOfOnePixel) {
  TwoViewFixture f(1, 1);
  f.settings.weight[Loss::kMultiViewGeometric] = f.settings.weight[Loss::kMultiViewPhotometric] = 1;
  compare(f);
}

TEST_F(CudaMultiView, DepthOfTheNeighbourIsTheCpus) {
  TwoViewFixture f = fixture();
  for (size_t i = 0; i < f.pixels(); i += 7) f.maps.expected[i] *= 1.3;
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 1.0f);
  f.view.data.mask.at(8, 3) = 0;
  const RenderMaps<float> maps = testing_maps::narrow(f.maps);
  for (const bool paper : {false, true}) {
    f.settings.paper_normals = paper;
    MapLossWorkspace<float> workspace;
    keep_neighbour_depth<float>({maps, f.view, f.settings}, workspace);
    DeviceArray<float> alpha, normal, distance, expected, depth(context(), maps.pixels(), "test");
    alpha.assign(context(), maps.alpha, "test");
    normal.assign(context(), maps.normal, "test");
    distance.assign(context(), maps.distance, "test");
    expected.assign(context(), maps.expected, "test");
    const TrainingMaps view(context(), f.view);
    keep_neighbour_depth(
        context(), {maps.width, maps.height, {}, normal.span(), alpha.span(), distance.span(), expected.span(), {}},
        view.spans(), paper, depth.span());
    EXPECT_EQ(depth.to_host()[3 * size_t(f.maps.width) + 8], 0.0f) << "masked";
    expect_close_maps(depth.to_host(), workspace.neighbour_depth, CudaTolerance().map, "depth");
  }
}

TEST_F(CudaMultiView, ScratchIsWithinItsForecast) {
  const TwoViewFixture f = fixture();
  const uint64_t forecast = multi_view_bytes(f.settings, f.pixels());
  EXPECT_GE(forecast, 8 * f.pixels() * sizeof(float));
  EXPECT_LE(forecast, 9 * f.pixels() * sizeof(float) + 4096);
  LossSettings none;
  EXPECT_EQ(multi_view_bytes(none, f.pixels()), 0u);
}

// ---- whole steps

class CudaMultiViewStep : public DeviceTest {
 protected:
  static std::unique_ptr<CudaEngine> make_engine(const CudaEngineOptions& options = {}) {
    auto engine = std::make_unique<CudaEngine>(test_device().index, 0, 1, options);
    engine->load(make_wall());
    engine->set_training_views(make_view_pair());
    return engine;
  }
  static EngineState state_of(const Engine& engine) {
    EngineState state;
    engine.save_state(state);
    return state;
  }
  /// The state after four steps in which the views take turns.
  static EngineState trained(const CudaEngineOptions& options = {}) {
    const std::unique_ptr<CudaEngine> engine = make_engine(options);
    StepRequest r = make_pair_request();
    for (r.step = 1; r.step <= 4; ++r.step) {
      r.view = static_cast<int>(r.step % 2);
      r.neighbour.view = 1 - r.view;
      EXPECT_FALSE(engine->step(r).non_finite.found);
    }
    return state_of(*engine);
  }
};

TEST_F(CudaMultiViewStep, GradientsAreThoseOfTheReference) {
  const std::unique_ptr<CudaEngine> engine = make_engine();
  const StepRequest r = make_pair_request();
  RenderOptions options;
  options.raster = r.raster;
  const ImageF depth = engine->render(make_view_pair()[1].data.camera, options).depth_plane;
  const StepReport report = engine->step(r);
  ASSERT_FALSE(report.non_finite.found) << report.non_finite.term;
  EXPECT_GT(report.losses[Loss::kMultiViewGeometric], 0);
  EXPECT_GT(report.losses[Loss::kMultiViewPhotometric], 0);
  const auto want = pair_gradients(engine->last_maps(), depth, r, true);
  const GaussianModel got = engine->last_gradients();
  const CudaTolerance t;
  EXPECT_NEAR(report.losses.total, want.losses.total, t.total_loss * want.losses.total);
  EXPECT_LE(difference(got.positions, want.gradient.positions).worst, t.two_view_gradient);
  EXPECT_LE(difference(got.log_scales, want.gradient.log_scales).worst, t.two_view_gradient);
  EXPECT_LE(difference(got.rotations, want.gradient.rotations).worst, t.two_view_gradient);
  EXPECT_LE(difference(got.opacity_logits, want.gradient.opacity_logits).worst, t.two_view_gradient);
}

TEST_F(CudaMultiViewStep, LossesAreThoseOfTheCpuEngine) {
  cpu::CpuEngine want(1);
  want.load(make_wall());
  want.set_training_views(make_view_pair());
  const StepReport a = make_engine()->step(make_pair_request()), b = want.step(make_pair_request());
  const CudaTolerance t;
  EXPECT_NEAR(a.losses[Loss::kMultiViewGeometric], b.losses[Loss::kMultiViewGeometric],
              t.two_views * b.losses[Loss::kMultiViewGeometric]);
  EXPECT_NEAR(a.losses[Loss::kMultiViewPhotometric], b.losses[Loss::kMultiViewPhotometric],
              t.two_views * b.losses[Loss::kMultiViewPhotometric]);
}

TEST_F(CudaMultiViewStep, AWarmStepWaitsOnceAndAllocatesNothing) {
  const std::unique_ptr<CudaEngine> engine = make_engine();
  StepRequest r = make_pair_request();
  for (r.step = 1; r.step <= 3; ++r.step) engine->step(r);
  const uint64_t waited = engine->context().synchronisations(), allocated = engine->context().allocations();
  engine->step(r);
  EXPECT_EQ(engine->context().synchronisations() - waited, 1u);
  EXPECT_EQ(engine->context().allocations() - allocated, 0u);
}

TEST_F(CudaMultiViewStep, GraphsAndTheOrderOfThreadsChangeNothing) {
  const EngineState plain = trained();
  CudaEngineOptions graphs;
  graphs.graphs = graphs.time_stages = true;
  for_each_thread_order([&] {
    const EngineState other = trained(graphs);
    EXPECT_EQ(other.model.positions, plain.model.positions);
    EXPECT_EQ(other.arrays, plain.arrays);
  });
}

TEST_F(CudaMultiViewStep, AStepIsRepeatedWhenTheNeighbourHasMorePairsThanRoom) {
  // Pairs beyond what the slack of a room holds: thousands of Gaussians that were points when the neighbour was
  // visited.
  RandomSceneOptions o;
  o.width = 160;
  o.height = 120;
  o.gaussians = 3000;
  o.channels = 0;
  o.log_scale_min = o.log_scale_max = -2.2;
  TrainingView second = make_view(o);
  second.data.camera.world_to_camera.translation.x += 0.1;
  const auto engine = std::make_unique<CudaEngine>(test_device().index, 0, 1);
  engine->load(make_model(o));
  engine->set_training_views({make_view(o), second});
  const EngineState large = state_of(*engine);
  EngineState small = large;
  for (float& s : small.model.log_scales) s = -6;
  const auto visit = [&](int view, const EngineState& state) {
    engine->load_state(state);
    StepRequest r = make_pair_request();
    r.view = view;
    r.neighbour.view = -1;
    engine->step(r);
  };
  visit(1, small);
  visit(0, large);
  engine->load_state(large);
  const uint64_t waited = engine->context().synchronisations();
  const StepReport report = engine->step(make_pair_request());
  EXPECT_FALSE(report.non_finite.found) << report.non_finite.term;
  EXPECT_EQ(engine->context().synchronisations() - waited, 2u) << "once more for the step that did not fit";
}

TEST_F(CudaMultiViewStep, WhatIsNotFiniteIsNamedAndNothingChanges) {
  const std::unique_ptr<CudaEngine> engine = make_engine();
  StepRequest r = make_pair_request();
  engine->step(r);
  EngineState state = state_of(*engine);
  state.model.log_scales[3 * 11 + 1] = kNotANumber;
  engine->load_state(state);
  const StepReport report = engine->step(r);
  EXPECT_EQ(report.non_finite.term, "log_scales");
  EXPECT_EQ(report.non_finite.gaussian, 11);
  EXPECT_EQ(state_of(*engine).model.positions, state.model.positions);
}

TEST_F(CudaMultiViewStep, TheTimerHasAStageForTheNeighbour) {
  CudaEngineOptions options;
  options.time_stages = true;
  const std::unique_ptr<CudaEngine> engine = make_engine(options);
  EXPECT_GT(engine->step(make_pair_request()).seconds.count("neighbour"), 0u);
}

}  // namespace
}  // namespace aligngs::cuda
