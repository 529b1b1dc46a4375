// Whole steps of the CUDA engine beside the CPU engine: losses, every gradient and statistic, and a short training.
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>

#include "device/testing/device.h"
#include "device/tolerances.h"
#include "engine/benchmark/step_benchmark.h"
#include "engine/cuda/cuda_engine.h"
#include "engine/testing/scenes.h"

namespace aligngs::cuda {
namespace {

using namespace cpu::testing_scene;
using cpu::testing_scene::RandomSceneOptions;

class CudaStep : public DeviceTest {
 protected:
  static std::unique_ptr<CudaEngine> make_engine(const CudaEngineOptions& settings = {}) {
    return std::make_unique<CudaEngine>(test_device().index, 0, 1, settings);
  }
  /// The state after three steps, the second on a view that was never visited; `seconds` of the last.
  static EngineState train(const CudaEngineOptions& settings, const RandomSceneOptions& o,
                           std::map<std::string, double>* seconds = nullptr) {
    TrainingView second = make_view(o);
    second.data.camera.world_to_camera.translation.x += 0.3;
    const std::unique_ptr<CudaEngine> engine = make_engine(settings);
    engine->load(make_model(o));
    engine->set_training_views({make_view(o), second});
    StepRequest r = make_geometry_request();
    for (r.step = 1; r.step <= 3; ++r.step) {
      r.view = static_cast<int>(r.step % 2);
      const StepReport report = engine->step(r);
      EXPECT_FALSE(report.non_finite.found) << report.non_finite.term;
      if (seconds != nullptr) *seconds = report.seconds;
    }
    EngineState state;
    engine->save_state(state);
    return state;
  }
  static void expect_same(const EngineState& a, const EngineState& b) {
    EXPECT_EQ(a.model.positions, b.model.positions);
    EXPECT_EQ(a.model.sh, b.model.sh);
    EXPECT_EQ(a.model.semantics, b.model.semantics);
    EXPECT_EQ(a.arrays, b.arrays);
  }

  template <class A, class B>
  static void expect_close(const A& a, const B& b, double tolerance, const std::string& what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    const Difference d = difference(a, b);
    EXPECT_LE(d.worst, tolerance) << what << ": entry " << d.at << " is " << (a.empty() ? 0 : a[d.at]) << " instead of "
                                  << (b.empty() ? 0 : b[d.at]) << ", largest " << d.scale;
  }

  static void compare_gradients(const GaussianModel& got, const GaussianModel& want, double shape, double semantic) {
    expect_close(got.positions, want.positions, shape, "d positions");
    expect_close(got.log_scales, want.log_scales, shape, "d log_scales");
    expect_close(got.rotations, want.rotations, shape, "d rotations");
    expect_close(got.opacity_logits, want.opacity_logits, shape, "d opacity_logits");
    expect_close(got.sh, want.sh, CudaTolerance().gradient, "d sh");
    expect_close(got.semantics, want.semantics, semantic, "d semantics");
  }

  static void compare_statistics(DensityStatistics got, DensityStatistics want) {
    const auto a = arrays_of(got), b = arrays_of(want);
    for (size_t k = 0; k < a.size(); ++k) {
      expect_close(*a[k].values, *b[k].values, CudaTolerance().statistic, std::string("density ") + a[k].name);
    }
  }

  static void compare(const GaussianModel& model, const TrainingView& view, const StepRequest& request,
                      const CudaEngineOptions& options = {}) {
    const CouplingBalance balance{2e-4, 1e-3};
    cpu::CpuEngine want(1);
    want.keep_features(true);
    want.set_semantic_products(cpu::SemanticProducts::kFloat32);
    want.load(model);
    want.set_training_views({view});
    want.set_coupling_balance(balance);
    const std::unique_ptr<CudaEngine> got = make_engine(options);
    got->load(model);
    got->set_training_views({view});
    got->set_coupling_balance(balance);
    StepRequest with_pose = request;
    with_pose.pose_gradient = true;
    const StepReport a = got->step(with_pose), b = want.step(with_pose);
    ASSERT_FALSE(a.non_finite.found) << a.non_finite.term << " of " << a.non_finite.gaussian;
    ASSERT_FALSE(b.non_finite.found) << b.non_finite.term;

    const CudaTolerance t;
    const bool coupled = model.semantic_channels > 0 && request.losses.coupling_strength != 0;
    EXPECT_EQ(a.visible, b.visible);
    EXPECT_EQ(a.coupling_scale, b.coupling_scale);
    EXPECT_NEAR(a.losses[Loss::kL1], b.losses[Loss::kL1], t.loss);
    EXPECT_NEAR(a.losses[Loss::kSsim], b.losses[Loss::kSsim], t.loss);
    EXPECT_NEAR(a.losses.psnr, b.losses.psnr, t.psnr);
    EXPECT_NEAR(a.losses[Loss::kLogDepth], b.losses[Loss::kLogDepth], t.loss);
    EXPECT_NEAR(a.losses[Loss::kNormalConsistency], b.losses[Loss::kNormalConsistency], t.normal_consistency);
    EXPECT_NEAR(a.losses[Loss::kPriorNormal], b.losses[Loss::kPriorNormal], t.loss);
    EXPECT_NEAR(a.losses[Loss::kFlatten], b.losses[Loss::kFlatten], t.loss);
    EXPECT_NEAR(a.losses[Loss::kOpacityL1], b.losses[Loss::kOpacityL1], t.loss);
    EXPECT_NEAR(a.losses[Loss::kScaleL1], b.losses[Loss::kScaleL1], t.loss);
    EXPECT_NEAR(a.losses[Loss::kSemanticSoft], b.losses[Loss::kSemanticSoft], t.semantic_loss);
    EXPECT_NEAR(a.losses[Loss::kSemanticHard], b.losses[Loss::kSemanticHard], t.semantic_loss);
    EXPECT_NEAR(a.losses.total, b.losses.total, t.total_loss * std::abs(b.losses.total) + 2 * t.semantic_loss);
    expect_close(got->last_maps().color, want.last_maps().color, t.map, "colour");
    compare_gradients(got->last_gradients(), want.last_gradients(), t.gradient + (coupled ? t.coupling : 0.0),
                      t.semantic_gradient);
    compare_statistics(got->density_statistics(), want.density_statistics());
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(a.pose.rotation[k], b.pose.rotation[k], t.pose * norm(b.pose.rotation) + 1e-9);
      EXPECT_NEAR(a.pose.translation[k], b.pose.translation[k], t.pose * norm(b.pose.translation) + 1e-9);
    }
    EXPECT_NEAR(got->coupling_balance().photometric, want.coupling_balance().photometric,
                t.photometric_rms * want.coupling_balance().photometric);
    EXPECT_NEAR(got->coupling_balance().semantic, want.coupling_balance().semantic,
                t.coupling_rms * want.coupling_balance().semantic);
  }
};

RandomSceneOptions scene(int channels, size_t gaussians = 120) {
  RandomSceneOptions o;
  o.width = 48;
  o.height = 37;  // no multiple of the tile
  o.channels = channels;
  o.gaussians = gaussians;
  return o;
}

TEST_F(CudaStep, PhotometricLosses) {
  const RandomSceneOptions o = scene(0);
  compare(make_model(o), make_view(o), make_request());
}

TEST_F(CudaStep, GeometryLosses) {
  const RandomSceneOptions o = scene(0);
  compare(make_model(o), make_view(o), make_geometry_request());
}

TEST_F(CudaStep, OpacityDropout) {
  StepRequest r = make_geometry_request();
  r.raster.dropout = {0.3f, 11};
  compare(make_model({}), make_view({}), r);
}

TEST_F(CudaStep, SevenClassesBounded) {
  const RandomSceneOptions o = scene(7);
  compare(make_model(o), make_view(o), make_geometry_request());
}

TEST_F(CudaStep, SevenClassesAsPrinted) {
  const RandomSceneOptions o = scene(7);
  StepRequest r = make_request();
  r.losses.semantic_blend = SemanticBlend::kLogits;
  r.losses.coupling = SemanticCoupling::kPlain;
  r.losses.coupling_strength = 1;
  compare(make_model(o), make_view(o), r);
}

TEST_F(CudaStep, OpacityInPlaceOfACoupling) {
  const RandomSceneOptions o = scene(7);  // with an omega that differs from pixel to pixel
  StepRequest r = make_request();
  r.losses.coupling = SemanticCoupling::kOpacity;
  compare(make_model(o), make_view(o), r);
}

TEST_F(CudaStep, OneClass) {
  const RandomSceneOptions o = scene(1);
  compare(make_model(o), make_view(o), make_request());
}

TEST_F(CudaStep, OneGaussian) {
  const RandomSceneOptions o = scene(7, 1);
  compare(make_model(o), make_view(o), make_request());
}

TEST_F(CudaStep, TheKernelsThatAreNotTheDefault) {
  CudaEngineOptions options;
  options.blend_backward = BlendBackwardMethod::kPerSplat;
  options.semantic_visit = SemanticVisitMethod::kCompacted;  // the emulation is a device of compute capability 9.0
  compare(make_model(scene(0)), make_view(scene(0)), make_request(), options);
  compare(make_model(scene(7)), make_view(scene(7)), make_geometry_request(), options);
  StepRequest printed = make_request();
  printed.losses.semantic_blend = SemanticBlend::kLogits;
  printed.losses.coupling = SemanticCoupling::kPlain;
  printed.losses.coupling_strength = 1;
  compare(make_model(scene(7)), make_view(scene(7)), printed, options);
  RandomSceneOptions many = scene(3, 600);
  many.width = many.height = 16;
  many.log_scale_max = -0.5;
  compare(make_model(many), make_view(many), make_geometry_request(), options);
}

TEST_F(CudaStep, WithoutDensityStatistics) {
  const RandomSceneOptions o = scene(0, 40);
  StepRequest r = make_request();
  r.collect_density = false;
  compare(make_model(o), make_view(o), r);
}

TEST_F(CudaStep, ManyInATile) {
  RandomSceneOptions o = scene(3, 600);
  o.width = o.height = 16;
  o.log_scale_max = -0.5;
  compare(make_model(o), make_view(o), make_request());
}

TEST_F(CudaStep, NothingVisibleLeavesTheModelAsItIs) {
  RandomSceneOptions o = scene(7, 30);
  o.depth_min = -3;
  o.depth_max = -1;
  const std::unique_ptr<CudaEngine> engine = make_engine();
  const GaussianModel before = make_model(o);
  engine->load(before);
  engine->set_training_views({make_view(o)});
  StepRequest r = make_request();
  r.losses.weight[Loss::kOpacityL1] = r.losses.weight[Loss::kScaleL1] = 0;
  const StepReport report = engine->step(r);
  EXPECT_FALSE(report.non_finite.found) << report.non_finite.term;
  EXPECT_EQ(report.visible, 0u);
  GaussianModel after;
  engine->store(after);
  EXPECT_EQ(after.positions, before.positions);
  EXPECT_EQ(after.semantics, before.semantics);
}

TEST_F(CudaStep, EmptyModelStepsAndRenders) {
  const RandomSceneOptions o = scene(7, 0);
  const std::unique_ptr<CudaEngine> engine = make_engine();
  engine->load(make_model(o));
  engine->set_training_views({make_view(o)});
  const StepReport report = engine->step(make_request());
  EXPECT_FALSE(report.non_finite.found) << report.non_finite.term;
  RenderOptions options;
  options.labels = true;
  const Rendering r = engine->render(make_camera(20, 10), options);
  for (const float a : r.alpha.data) EXPECT_EQ(a, 0.0f);
}

TEST_F(CudaStep, NonFiniteLossIsNamedAndNothingChanges) {
  const RandomSceneOptions o = scene(7, 60);
  const std::unique_ptr<CudaEngine> engine = make_engine();
  engine->load(make_model(o));
  TrainingView bad = make_view(o);
  bad.data.color.at(20, 20, 1) = std::numeric_limits<float>::quiet_NaN();
  engine->set_training_views({make_view(o), bad});
  StepRequest r = make_request();
  engine->step(r);
  EngineState before, after;
  engine->save_state(before);
  r.view = 1;
  r.step = 2;
  const StepReport report = engine->step(r);
  EXPECT_TRUE(report.non_finite.found);
  EXPECT_EQ(report.non_finite.gaussian, -1);
  EXPECT_EQ(report.non_finite.term, "l1");
  engine->save_state(after);
  EXPECT_EQ(before.model.positions, after.model.positions);
  EXPECT_EQ(before.arrays, after.arrays);
}

TEST_F(CudaStep, NonFiniteParameterIsNamedAndNothingChanges) {
  const RandomSceneOptions o = scene(7, 60);
  const std::unique_ptr<CudaEngine> engine = make_engine();
  engine->load(make_model(o));
  engine->set_training_views({make_view(o)});
  StepRequest r = make_request();
  engine->step(r);
  EngineState state, after;
  engine->save_state(state);
  state.model.log_scales[3 * 11 + 1] = std::numeric_limits<float>::quiet_NaN();
  engine->load_state(state);
  r.step = 2;
  const StepReport report = engine->step(r);
  EXPECT_TRUE(report.non_finite.found);
  EXPECT_EQ(report.non_finite.term, "log_scales");
  EXPECT_EQ(report.non_finite.gaussian, 11);
  engine->save_state(after);
  EXPECT_EQ(state.model.positions, after.model.positions);
  EXPECT_EQ(state.model.sh, after.model.sh);
}

TEST_F(CudaStep, AViewWithMorePairsThanRoomIsRepeatedAlsoAsAGraph) {
  // Scales a thousand times larger between two visits: pairs outgrow the room of the first visit.
  RandomSceneOptions o = scene(0, 3000);
  o.width = 160;
  o.height = 120;
  o.log_scale_min = o.log_scale_max = -6;
  o.logit_min = o.logit_max = 3;
  for (const bool graphs : {false, true}) {
    CudaEngineOptions settings;
    settings.graphs = graphs;
    const std::unique_ptr<CudaEngine> engine = make_engine(settings);
    engine->load(make_model(o));
    engine->set_training_views({make_view(o)});
    StepRequest r = make_request();
    EXPECT_FALSE(engine->step(r).non_finite.found);
    EngineState state;
    engine->save_state(state);
    for (float& s : state.model.log_scales) s = -2.2f;
    engine->load_state(state);
    r.step = 2;
    const StepReport report = engine->step(r);
    EXPECT_FALSE(report.non_finite.found) << report.non_finite.term;
    EXPECT_GT(report.visible, 0u);
    EXPECT_EQ(engine->graph_counts().launched, graphs ? 1u : 0u) << "the second attempt needs more memory";
    EXPECT_EQ(engine->graph_counts().grown, graphs ? 1u : 0u);
  }
}

TEST_F(CudaStep, AWarmStepWaitsOnceAndAllocatesNothing) {
  const RandomSceneOptions o = scene(7, 60);
  const std::unique_ptr<CudaEngine> engine = make_engine();
  engine->load(make_model(o));
  engine->set_training_views({make_view(o)});
  StepRequest r = make_geometry_request();
  for (r.step = 1; r.step <= 3; ++r.step) engine->step(r);
  const uint64_t waited = engine->context().synchronisations(), allocated = engine->context().allocations();
  engine->step(r);
  EXPECT_EQ(engine->context().synchronisations() - waited, 1u);
  EXPECT_EQ(engine->context().allocations() - allocated, 0u);
}

TEST_F(CudaStep, SameBitsOnEveryRunAndInEveryOrderOfThreads) {
  const RandomSceneOptions o = scene(7, 60);
  const auto train = [&] {
    const std::unique_ptr<CudaEngine> engine = make_engine();
    engine->load(make_model(o));
    engine->set_training_views({make_view(o)});
    StepRequest r = make_geometry_request();
    for (r.step = 1; r.step <= 2; ++r.step) engine->step(r);
    EngineState state;
    engine->save_state(state);
    return state;
  };
  const EngineState first = train();
  for_each_thread_order([&] {
    const EngineState again = train();
    EXPECT_EQ(again.model.positions, first.model.positions);
    EXPECT_EQ(again.model.semantics, first.model.semantics);
    EXPECT_EQ(again.arrays, first.arrays);
  });
}

TEST_F(CudaStep, TimersReportEveryStageOfTheCpuEngineAndChangeNothing) {
  CudaEngineOptions timed;
  timed.time_stages = true;
  for (const int channels : {7, 0}) {
    const RandomSceneOptions o = scene(channels, 60);
    std::map<std::string, double> stages, plain;
    expect_same(train(timed, o, &stages), train({}, o, &plain));
    std::set<std::string> names;
    for (const auto& [name, seconds] : stages) {
      EXPECT_GT(seconds, 0) << name;
      names.insert(name);
    }
    std::set<std::string> expected(stage_names().begin(), stage_names().end());
    if (channels == 0) {
      expected.erase("semantic_rows");
      expected.erase("semantics");
    }
    EXPECT_EQ(names, expected);
    EXPECT_EQ(plain.size(), 1u);
    EXPECT_GT(plain["step"], 0);
  }
}

TEST_F(CudaStep, GraphsOfStepsChangeNothing) {
  CudaEngineOptions graphs;
  graphs.graphs = graphs.time_stages = true;
  const RandomSceneOptions o = scene(7, 60);
  expect_same(train(graphs, o), train({}, o));
}

/// Two views in turn, classes, a restructuring in between. The first visit to a view waits. All later ones are a graph,
/// which is made once, and again after the restructuring.
TEST_F(CudaStep, AWarmStepIsOneGraphOfTheSameOperations) {
  CudaEngineOptions graphs;
  graphs.graphs = true;
  const RandomSceneOptions o = scene(7, 60);
  TrainingView second = make_view(o);
  second.data.camera.world_to_camera.translation.x += 0.3;
  const std::unique_ptr<CudaEngine> engine = make_engine(graphs);
  engine->load(make_model(o));
  engine->set_training_views({make_view(o), second});
  StepRequest r = make_geometry_request();
  const auto steps = [&](int count) {
    for (int i = 0; i < count; ++i, ++r.step) {
      r.view = static_cast<int>(r.step % 2);
      EXPECT_FALSE(engine->step(r).non_finite.found);
    }
  };
  steps(2);
  EXPECT_EQ(engine->graph_counts().launched, 0u);
  steps(4);
  EXPECT_EQ(engine->graph_counts().launched, 4u);
  EXPECT_EQ(engine->graph_counts().instantiated, 1u);
  EXPECT_EQ(engine->graph_counts().updated, 3u);
  EXPECT_EQ(engine->graph_counts().failed, 0u);
  const size_t nodes = engine->graph_counts().nodes;
  EXPECT_GT(nodes, 20u);
  engine->restructure(plan_keep(std::vector<uint8_t>(60, 1)));
  steps(2);
  EXPECT_EQ(engine->graph_counts().instantiated, 2u);
  EXPECT_EQ(engine->graph_counts().nodes, nodes);
  r.losses = make_request().losses;  // without geometry there are fewer operations
  steps(1);
  EXPECT_EQ(engine->graph_counts().instantiated, 3u);
  EXPECT_LT(engine->graph_counts().nodes, nodes);
}

TEST_F(CudaStep, AShortTrainingFollowsTheCpuEngine) {
  const RandomSceneOptions o = scene(7, 100);
  TrainingView second = make_view(o);
  second.data.camera.world_to_camera.translation.x += 0.3;
  const std::vector<TrainingView> views = {make_view(o), second};
  cpu::CpuEngine cpu(1);
  cpu.set_semantic_products(cpu::SemanticProducts::kFloat32);
  const std::unique_ptr<CudaEngine> cuda = make_engine();
  for (Engine* e : {static_cast<Engine*>(&cpu), static_cast<Engine*>(cuda.get())}) {
    e->load(make_model(o));
    e->set_training_views(views);
  }
  StepRequest r = make_geometry_request();
  double start = 0, last_cpu = 0, last_cuda = 0;
  for (r.step = 1; r.step <= 12; ++r.step) {
    r.view = static_cast<int>(r.step % 2);
    const StepReport a = cuda->step(r), b = cpu.step(r);
    ASSERT_FALSE(a.non_finite.found) << a.non_finite.term;
    EXPECT_NEAR(a.losses.total, b.losses.total, CudaTolerance().trajectory * b.losses.total) << "step " << r.step;
    if (r.step == 2) start = b.losses.total;
    last_cpu = b.losses.total;
    last_cuda = a.losses.total;
  }
  EXPECT_LT(last_cpu, start);
  EXPECT_LT(last_cuda, start);
}

}  // namespace
}  // namespace aligngs::cuda
