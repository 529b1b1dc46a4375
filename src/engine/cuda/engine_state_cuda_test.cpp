// Loading, saving, restructuring and rendering with the CUDA engine, beside the CPU engine and the reference.
#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "device/testing/device.h"
#include "device/tolerances.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/cuda/cuda_engine.h"
#include "engine/cuda/make_engine.h"
#include "engine/testing/scenes.h"

namespace aligngs::cuda {
namespace {

using namespace cpu::testing_scene;
using cpu::testing_scene::RandomSceneOptions;

class CudaEngineState : public DeviceTest {
 protected:
  std::unique_ptr<Engine> engine(const GaussianModel& model, const std::vector<TrainingView>& views = {}) {
    std::unique_ptr<Engine> e = make_cuda_engine(test_device().index, 0, 1);
    e->set_training_views(views);
    e->load(model);
    return e;
  }
  static EngineState state_of(const Engine& e) {
    EngineState s;
    e.save_state(s);
    return s;
  }
};

RandomSceneOptions small_scene() {
  RandomSceneOptions o;
  o.width = 40;
  o.height = 29;
  o.gaussians = 80;
  return o;
}

TEST_F(CudaEngineState, StoredIsWhatWasLoaded) {
  const GaussianModel model = make_model(small_scene());
  const std::unique_ptr<Engine> e = engine(model);
  EXPECT_EQ(e->size(), model.size());
  GaussianModel out;
  e->store(out);
  EXPECT_EQ(out.positions, model.positions);
  EXPECT_EQ(out.sh, model.sh);
  EXPECT_EQ(out.semantics, model.semantics);
  EXPECT_EQ(out.semantic_channels, model.semantic_channels);
  EXPECT_EQ(out.sh_degree, model.sh_degree);
}

TEST_F(CudaEngineState, SavedAndLoadedGoesOnAsIfNeverStopped) {
  const RandomSceneOptions o = small_scene();
  const std::unique_ptr<Engine> e = engine(make_model(o), {make_view(o)});
  StepRequest r = make_request();
  e->step(r);
  const EngineState middle = state_of(*e);
  r.step = 2;
  e->step(r);
  const std::unique_ptr<Engine> resumed = engine(make_model(o), {make_view(o)});
  resumed->load_state(middle);
  resumed->step(r);
  const EngineState a = state_of(*e), b = state_of(*resumed);
  EXPECT_EQ(a.model.positions, b.model.positions);
  EXPECT_EQ(a.model.semantics, b.model.semantics);
  EXPECT_EQ(a.arrays, b.arrays);
}

TEST_F(CudaEngineState, ACheckpointOfOneEngineContinuesOnTheOther) {
  const RandomSceneOptions o = small_scene();
  cpu::CpuEngine cpu(1);
  cpu.load(make_model(o));
  cpu.set_training_views({make_view(o)});
  cpu.step(make_request());
  EngineState before;
  cpu.save_state(before);
  const std::unique_ptr<Engine> cuda = engine(make_model(o), {make_view(o)});
  cuda->load_state(before);
  const EngineState after = state_of(*cuda);
  EXPECT_EQ(before.model.rotations, after.model.rotations);
  EXPECT_EQ(before.arrays, after.arrays);
}

TEST_F(CudaEngineState, RefusesAStateThatLacksAnArray) {
  const std::unique_ptr<Engine> e = engine(make_model(small_scene()));
  EngineState state = state_of(*e);
  state.arrays.erase("adam_v.sh");
  EXPECT_THROW(e->load_state(state), Error);
}

TEST_F(CudaEngineState, RestructuresAsTheCpuEngine) {
  const RandomSceneOptions o = small_scene();
  const std::unique_ptr<Engine> cuda = engine(make_model(o), {make_view(o)});
  cuda->step(make_request());
  EngineState state = state_of(*cuda);
  cpu::CpuEngine cpu(1);
  cpu.load_state(state);
  RestructurePlan plan;
  RowOrigin keep, clone, split;
  keep.source = 7;
  clone.source = split.source = 3;
  clone.kind = RowOrigin::Kind::kClone;
  clone.offset[1] = 0.25f;
  split.kind = RowOrigin::Kind::kSplit;
  split.offset[2] = -0.125f;
  split.shrink = 1.6f;
  plan.rows = {keep, clone, split, keep};
  cuda->restructure(plan);
  cpu.restructure(plan);
  const EngineState a = state_of(*cuda), b = state_of(cpu);
  EXPECT_EQ(cuda->size(), 4u);
  EXPECT_EQ(a.model.positions, b.model.positions);
  EXPECT_EQ(a.model.log_scales, b.model.log_scales);
  EXPECT_EQ(a.model.sh, b.model.sh);
  EXPECT_EQ(a.model.semantics, b.model.semantics);
  EXPECT_EQ(a.arrays, b.arrays);
}

TEST_F(CudaEngineState, APlanOfAnotherModelIsAnError) {
  const std::unique_ptr<Engine> e = engine(make_model(small_scene()));
  RestructurePlan plan;
  plan.rows.resize(1);
  plan.rows[0].source = 80;
  EXPECT_THROW(e->restructure(plan), Error);
}

TEST_F(CudaEngineState, OpacityResetCapsAndForgets) {
  const RandomSceneOptions o = small_scene();
  const std::unique_ptr<Engine> e = engine(make_model(o), {make_view(o)});
  e->step(make_request());
  e->reset_opacity(0.01f);
  const EngineState s = state_of(*e);
  for (const float x : s.model.opacity_logits) EXPECT_LE(1 / (1 + std::exp(-x)), 0.0100001f);
  for (const float x : s.arrays.at("adam_m.opacity_logits")) EXPECT_EQ(x, 0.0f);
  EXPECT_THROW(e->reset_opacity(1.5f), Error);
}

TEST_F(CudaEngineState, NoiseOnPositionsIsThatOfTheCpu) {
  const RandomSceneOptions o = small_scene();
  GaussianModel model = make_model(o);
  for (float& x : model.opacity_logits) x = -6;
  const std::unique_ptr<Engine> cuda = engine(model);
  cpu::CpuEngine cpu(1);
  cpu.load(model);
  cuda->add_position_noise({2, 5});
  cpu.add_position_noise({2, 5});
  EngineState want;
  cpu.save_state(want);
  EXPECT_NE(want.model.positions, model.positions);
  const EngineState got = state_of(*cuda);
  EXPECT_LE(cpu::testing_scene::difference(got.model.positions, want.model.positions).worst,
            CudaTolerance().parameter * 10);
}

TEST_F(CudaEngineState, ScalesAreRaisedAsOnTheCpu) {
  const RandomSceneOptions o = small_scene();
  const std::unique_ptr<Engine> cuda = engine(make_model(o));
  cpu::CpuEngine cpu(1);
  cpu.load(make_model(o));
  std::vector<float> floors(make_model(o).size(), -2.0f);
  floors[1] = -std::numeric_limits<float>::infinity();
  cuda->raise_scales(floors);
  cpu.raise_scales(floors);
  EngineState want;
  cpu.save_state(want);
  EXPECT_EQ(state_of(*cuda).model.log_scales, want.model.log_scales);
  floors.pop_back();
  EXPECT_THROW(cuda->raise_scales(floors), Error);
}

TEST_F(CudaEngineState, RenderingMatchesTheReference) {
  const RandomSceneOptions o = small_scene();
  const GaussianModel model = make_model(o);
  const std::unique_ptr<Engine> e = engine(model);
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    RenderOptions options;
    options.labels = true;
    options.semantic_blend = blend;
    options.raster.background[1] = 0.4f;
    const Camera camera = make_camera(61, 43);
    const Rendering got = e->render(camera, options);
    const Rendering want = reference::render<double>(to_double(model), camera, options);
    const auto close = [](const ImageF& a, const ImageF& b, double tolerance, const char* what) {
      const Difference d = difference(a.data, b.data);
      EXPECT_LE(d.worst, tolerance) << what << " at " << d.at;
    };
    const CudaTolerance t;
    close(got.color, want.color, t.map, "colour");
    close(got.alpha, want.alpha, t.map, "alpha");
    close(got.normal, want.normal, t.unit_normal, "normal");
    close(got.depth_plane, want.depth_plane, t.depth, "plane depth");
    close(got.depth_median, want.depth_median, t.depth, "median depth");
    close(got.depth_expected, want.depth_expected, t.depth, "expected depth");
    close(got.label_probability, want.label_probability, t.label_probability, "label probability");
    size_t different = 0;
    for (size_t u = 0; u < got.label.data.size(); ++u) different += got.label.data[u] != want.label.data[u];
    EXPECT_LE(different, 1u);  // a tie of two classes or an alpha of 0.5 may fall either way
  }
}

TEST_F(CudaEngineState, RenderingWithoutGeometryOrLabelsLeavesThemEmpty) {
  const std::unique_ptr<Engine> e = engine(make_model(small_scene()));
  RenderOptions options;
  options.geometry = false;
  const Rendering r = e->render(make_camera(20, 20), options);
  EXPECT_EQ(r.color.data.size(), 1200u);
  EXPECT_TRUE(r.normal.data.empty());
  EXPECT_TRUE(r.label.data.empty());
}

TEST_F(CudaEngineState, LiftIsThatOfTheCpuEngine) {
  const RandomSceneOptions o = small_scene();
  GaussianModel model = make_model(o);
  std::fill(model.semantics.begin(), model.semantics.end(), 0.0f);
  const std::vector<TrainingView> views = {make_view(o)};
  cpu::CpuEngine cpu(1);
  const std::unique_ptr<Engine> cuda = engine(model, views);
  cpu.load(model);
  cpu.set_training_views(views);
  cpu.lift_semantics({});
  cuda->lift_semantics({});
  GaussianModel got, want;
  cuda->store(got);
  cpu.store(want);
  EXPECT_LE(difference(got.semantics, want.semantics).worst, CudaTolerance().lift);
}

TEST_F(CudaEngineState, ShapesAreTheModelWithoutColoursAndClasses) {
  const GaussianModel model = make_model(small_scene());
  const std::unique_ptr<Engine> cuda = engine(model);
  GaussianModel shapes;
  cuda->store_shapes(shapes);
  EXPECT_EQ(shapes.positions, model.positions);
  EXPECT_EQ(shapes.log_scales, model.log_scales);
  EXPECT_EQ(shapes.rotations, model.rotations);
  EXPECT_EQ(shapes.opacity_logits, model.opacity_logits);
  EXPECT_TRUE(shapes.sh.empty() && shapes.semantics.empty());
}

TEST_F(CudaEngineState, MergedClassesComeOutWhole) {
  RandomSceneOptions o = small_scene();
  o.channels = 12;
  const GaussianModel model = make_model(o);
  const std::vector<TrainingView> views = {make_view(o)};
  cpu::CpuEngine cpu(1);
  const std::unique_ptr<Engine> cuda = make_cuda_engine(test_device().index, 0, 1);
  for (Engine* e : {static_cast<Engine*>(&cpu), cuda.get()}) {
    e->prepare({views, 1, &model});
  }
  GaussianModel got, want;
  cuda->store(got);
  cpu.store(want);
  EXPECT_EQ(got.semantic_channels, 12);
  EXPECT_EQ(got.semantics, want.semantics);
}

TEST_F(CudaEngineState, TooLittleMemoryIsTyped) {
  try {
    const std::unique_ptr<Engine> e = make_cuda_engine(test_device().index, 100000, 1);
    RandomSceneOptions o = small_scene();
    o.gaussians = 5000;
    e->load(make_model(o));
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_NE(std::string(e.what()).find("the Gaussians"), std::string::npos) << e.what();
  }
}

TEST_F(CudaEngineState, WhatIsPredictedIsEnoughForEveryStepAndNotFarTooMuch) {
  RandomSceneOptions o;
  o.width = 80;
  o.height = 60;
  o.gaussians = 1000;
  o.log_scale_min = o.log_scale_max = -5;
  const std::vector<TrainingView> views = {make_view(o), make_view(o)};
  const GaussianModel model = make_model(o);
  const auto needed = [&](const Engine& e) {
    return e.own_memory(views, 0)->views +
           e.predicted_bytes(model.size(), model.semantic_channels, size_t(o.width) * o.height);
  };
  const uint64_t budget = needed(*make_cuda_engine(test_device().index, 0, 1));
  const auto train = [&](uint64_t bytes) {
    const std::unique_ptr<Engine> e = make_cuda_engine(test_device().index, bytes, 1);
    EXPECT_EQ(e->own_memory(views, 0)->limit, bytes);
    e->load(model);
    e->set_training_views(views);
    StepRequest r = make_geometry_request();
    for (r.step = 1; r.step <= 3; ++r.step) {
      r.view = static_cast<int>(r.step % 2);
      e->step(r);
    }
    e->lift_semantics({});
  };
  EXPECT_NO_THROW(train(budget));
  EXPECT_THROW(train(budget / 3), Error);
}

TEST_F(CudaEngineState, OwnMemoryCountsTheClassesThatRowsWillCarry) {
  RandomSceneOptions o = small_scene();
  o.channels = 12;
  std::vector<TrainingView> views = {make_view(o)};
  std::vector<uint16_t>& teacher = views[0].data.semantics.probabilities;
  for (size_t i = 0; i < teacher.size(); ++i) {
    if (i % 12 >= 4) teacher[i] = 0;  // eight classes that nobody sees
  }
  const std::unique_ptr<Engine> e = make_cuda_engine(test_device().index, uint64_t(1) << 30, 1);
  const OwnMemory all = *e->own_memory(views, 0), few = *e->own_memory(views, 1);
  EXPECT_EQ(all.channels, 0);
  EXPECT_EQ(few.channels, 5);
  EXPECT_LT(few.views, all.views);
}

TEST_F(CudaEngineState, PredictedBytesCoverTheModelAndGrow) {
  const RandomSceneOptions o = small_scene();
  const std::unique_ptr<Engine> e = engine(make_model(o), {make_view(o)});
  const uint64_t few = e->predicted_bytes(1000, 7, 640 * 480), many = e->predicted_bytes(2000, 7, 640 * 480);
  EXPECT_GT(few, 3u * ModelArrays::bytes(1000, 7));
  EXPECT_GT(many, few + 3u * ModelArrays::bytes(1000, 7));
}

}  // namespace
}  // namespace aligngs::cuda
