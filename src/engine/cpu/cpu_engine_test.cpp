// The engine as the trainer uses it: steps, state, restructuring, rendering, and what happens when something is wrong.
#include "engine/cpu/cpu_engine.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/error.h"
#include "engine/cpu/testing/engine_runs.h"
#include "engine/engine_arrays.h"
#include "engine/formulas/adam.h"
#include "engine/testing/scenes.h"
#include "gaussians/morton_order.h"
#include "gaussians/restructure.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(CpuEngine, BitIdenticalForAnyNumberOfThreads) {
  RandomSceneOptions o;
  o.width = 150;
  o.height = 70;
  o.gaussians = 2500;  // several chunks of every parallel loop
  EngineState states[3];
  for (int threads = 1; threads <= 3; ++threads) {
    CpuEngine engine(threads);
    engine.load(make_model(o));
    engine.set_training_views(two_views(o));
    run_steps(engine, 1, 5);
    states[threads - 1] = state_of(engine);
  }
  expect_same_state(states[0], states[1]);
  expect_same_state(states[0], states[2]);
}

TEST(CpuEngine, LossFallsOverSomeSteps) {
  const RandomSceneOptions o;
  CpuEngine engine(2);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  const double start = engine.step(r).losses.total;
  double end = start;
  for (r.step = 2; r.step <= 60; ++r.step) end = engine.step(r).losses.total;
  EXPECT_LT(end, 0.8 * start);
}

TEST(CpuEngine, NothingVisibleLeavesTheModelAsItIs) {
  RandomSceneOptions o;
  o.depth_min = -3;
  o.depth_max = -1;  // all behind the camera
  CpuEngine engine(2);
  const GaussianModel before = make_model(o);
  engine.load(before);
  engine.set_training_views({make_view(o)});
  StepRequest r = make_geometry_request();
  r.losses.weight[Loss::kOpacityL1] = r.losses.weight[Loss::kScaleL1] = 0;
  const StepReport report = engine.step(r);
  EXPECT_FALSE(report.non_finite.found) << report.non_finite.term;
  EXPECT_EQ(report.visible, 0u);
  EXPECT_GT(report.losses[Loss::kL1], 0);
  GaussianModel after;
  engine.store(after);
  EXPECT_TRUE(same_bits(before.positions, after.positions));
  EXPECT_TRUE(same_bits(before.opacity_logits, after.opacity_logits));
  EXPECT_TRUE(same_bits(before.semantics, after.semantics));
}

TEST(CpuEngine, ShapesAreTheModelWithoutColoursAndClasses) {
  CpuEngine engine(1);
  const GaussianModel model = make_model({});
  engine.load(model);
  GaussianModel shapes;
  engine.store_shapes(shapes);
  EXPECT_TRUE(same_bits(model.positions, shapes.positions));
  EXPECT_TRUE(same_bits(model.log_scales, shapes.log_scales));
  EXPECT_TRUE(same_bits(model.rotations, shapes.rotations));
  EXPECT_TRUE(same_bits(model.opacity_logits, shapes.opacity_logits));
  EXPECT_EQ(shapes.sh_degree, model.sh_degree);
  EXPECT_EQ(shapes.semantic_channels, 0);
  EXPECT_TRUE(shapes.sh.empty() && shapes.semantics.empty());
}

TEST(CpuEngine, EmptyModelStepsAndRenders) {
  RandomSceneOptions o;
  o.gaussians = 0;
  CpuEngine engine(2);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  EXPECT_FALSE(engine.step(make_geometry_request()).non_finite.found);
  RenderOptions options;
  options.labels = true;
  options.raster.background[1] = 0.25f;
  const Rendering r = engine.render(make_camera(20, 10), options);
  EXPECT_FLOAT_EQ(r.color.at(3, 3, 1), 0.25f);
  EXPECT_EQ(r.label.at(3, 3), kNoLabel);
}

TEST(CpuEngine, SavedAndLoadedGoesOnAsIfNeverStopped) {
  const RandomSceneOptions o;
  CpuEngine straight(2);
  straight.load(make_model(o));
  straight.set_training_views(two_views(o));
  run_steps(straight, 1, 4);
  const EngineState middle = state_of(straight);
  run_steps(straight, 5, 8);

  CpuEngine resumed(1);
  resumed.load_state(middle);
  resumed.set_training_views(two_views(o));
  run_steps(resumed, 5, 8);
  expect_same_state(state_of(straight), state_of(resumed));
}

TEST(CpuEngine, RefusesAStateThatLacksAnArray) {
  const RandomSceneOptions o;
  CpuEngine engine(1);
  engine.load(make_model(o));
  EngineState state = state_of(engine);
  state.arrays.erase("adam_v.sh");
  try {
    engine.load_state(state);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(e.details().field, "adam_v.sh");
  }
  EXPECT_EQ(engine.size(), o.gaussians);
}

/// Steps after rows have changed places give the same rows, bit for bit, in the new places.
TEST(CpuEngine, StepsDoNotDependOnTheOrderOfRows) {
  RandomSceneOptions o;
  o.channels = 0;  // the coupling's factor is a sum over rows, whose rounding depends on their order
  CpuEngine plain(1), ordered(1);
  for (CpuEngine* engine : {&plain, &ordered}) {
    engine->load(make_model(o));
    engine->set_training_views(two_views(o));
    run_steps(*engine, 1, 3);
  }
  GaussianModel model;
  ordered.store(model);
  RestructurePlan plan = plan_keep(std::vector<uint8_t>(model.size(), 1));
  sort_by_morton(model, plan);
  ordered.restructure(plan);
  DensityStatistics want = plain.density_statistics(), got = ordered.density_statistics();
  for (const NamedArray& a : arrays_of(want)) restructure_rows(plan, a.width, *a.values);
  for (size_t k = 0; k < arrays_of(want).size(); ++k) {
    EXPECT_EQ(*arrays_of(got)[k].values, *arrays_of(want)[k].values) << arrays_of(want)[k].name;
  }
  run_steps(plain, 4, 6);
  run_steps(ordered, 4, 6);
  plain.restructure(plan);
  expect_same_state(state_of(plain), state_of(ordered));
}

TEST(CpuEngine, RestructureCarriesMomentsAndZeroesThoseOfNewRows) {
  const RandomSceneOptions o;
  CpuEngine engine(2);
  engine.load(make_model(o));
  engine.set_training_views(two_views(o));
  run_steps(engine, 1, 3);
  const EngineState before = state_of(engine);
  RestructurePlan plan;
  RowOrigin keep, clone;
  keep.source = 7;
  clone.source = 7;
  clone.kind = RowOrigin::Kind::kClone;
  plan.rows = {keep, clone};
  keep.source = 3;
  plan.rows.push_back(keep);
  engine.restructure(plan);
  ASSERT_EQ(engine.size(), 3u);
  const EngineState after = state_of(engine);
  const std::vector<float>& updates = after.arrays.at("adam_updates.semantics");
  EXPECT_EQ(updates, (std::vector<float>{before.arrays.at("adam_updates.semantics")[7], 0,
                                         before.arrays.at("adam_updates.semantics")[3]}));
  for (const char* name : {"adam_m.sh", "adam_v.sh"}) {
    const std::vector<float>&a = before.arrays.at(name), &b = after.arrays.at(name);
    for (int k = 0; k < 48; ++k) {
      EXPECT_EQ(b[k], a[7 * 48 + k]);
      EXPECT_EQ(b[48 + k], 0.0f);
      EXPECT_EQ(b[96 + k], a[3 * 48 + k]);
    }
  }
  EXPECT_EQ(after.model.semantics.size(), 3u * o.channels);
  EXPECT_EQ(engine.density_statistics().gradient.size(), 3u);
  run_steps(engine, 4, 5);
}

TEST(CpuEngine, OpacityResetCapsAndForgets) {
  const RandomSceneOptions o;
  CpuEngine engine(1);
  engine.load(make_model(o));
  engine.set_training_views(two_views(o));
  run_steps(engine, 1, 2);
  engine.reset_opacity(0.01f);
  const EngineState s = state_of(engine);
  for (const float x : s.model.opacity_logits) EXPECT_LE(1 / (1 + std::exp(-x)), 0.0100001f);
  for (const float x : s.arrays.at("adam_m.opacity_logits")) EXPECT_EQ(x, 0.0f);
  for (const float x : s.arrays.at("adam_v.opacity_logits")) EXPECT_EQ(x, 0.0f);
}

TEST(CpuEngine, NonFiniteParameterIsNamedAndNothingChanges) {
  const RandomSceneOptions o;
  struct Case {
    const char* term;
    std::vector<float> GaussianModel::*values;
    size_t width;
  };
  const Case cases[] = {{"positions", &GaussianModel::positions, 3},
                        {"log_scales", &GaussianModel::log_scales, 3},
                        {"rotations", &GaussianModel::rotations, 4},
                        {"opacity_logits", &GaussianModel::opacity_logits, 1},
                        {"sh", &GaussianModel::sh, 48},
                        {"semantics", &GaussianModel::semantics, 7}};
  for (const Case& c : cases) {
    GaussianModel model = make_model(o);
    // A row that is in view: SH and semantics are looked at only there.
    CpuEngine engine(2);
    engine.load(model);
    engine.set_training_views(two_views(o));
    run_steps(engine, 1, 2);
    const std::vector<float> seen = engine.density_statistics().weight;
    const size_t row = static_cast<size_t>(std::max_element(seen.begin(), seen.end()) - seen.begin());
    EngineState state = state_of(engine);
    (state.model.*c.values)[c.width * row] = kNan;
    engine.load_state(state);
    StepRequest r = make_geometry_request();
    r.step = 3;
    const StepReport report = engine.step(r);
    EXPECT_TRUE(report.non_finite.found) << c.term;
    EXPECT_EQ(report.non_finite.term, c.term);
    EXPECT_EQ(report.non_finite.gaussian, static_cast<int64_t>(row)) << c.term;
    expect_same_state(state, state_of(engine));
  }
}

TEST(CpuEngine, NonFiniteLossIsNamedAndNothingChanges) {
  const RandomSceneOptions o;
  CpuEngine engine(2);
  engine.load(make_model(o));
  std::vector<TrainingView> views = two_views(o);
  views[1].data.color.at(20, 20, 1) = kNan;
  engine.set_training_views(views);
  StepRequest r = make_request();
  engine.step(r);
  const EngineState before = state_of(engine);
  r.view = 1;
  r.step = 2;
  const StepReport report = engine.step(r);
  EXPECT_TRUE(report.non_finite.found);
  EXPECT_EQ(report.non_finite.gaussian, -1);
  EXPECT_EQ(report.non_finite.term, "l1");
  expect_same_state(before, state_of(engine));
}

TEST(CpuEngine, OverflowingGradientIsNamedAndNothingChanges) {
  const RandomSceneOptions o;
  CpuEngine engine(2);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  engine.step(r);
  const EngineState before = state_of(engine);
  r.step = 2;
  r.losses.weight[Loss::kL1] = 1e30f;
  const StepReport report = engine.step(r);
  EXPECT_TRUE(report.non_finite.found);
  EXPECT_GE(report.non_finite.gaussian, 0);
  expect_same_state(before, state_of(engine));
}

TEST(CpuEngine, InvisibleSemanticRowsRestWhenAsked) {
  RandomSceneOptions o;
  CpuEngine engine(2);
  GaussianModel model = make_model(o);
  engine.load(model);
  engine.set_training_views({make_view(o), make_view(o)});
  StepRequest r = make_request();
  engine.step(r);  // gives every visible row moments
  const EngineState first = state_of(engine);
  // Behind the camera from now on.
  EngineState hidden = first;
  for (size_t i = 0; i < hidden.model.size(); ++i) hidden.model.positions[3 * i + 2] -= 50;
  for (const bool skip : {true, false}) {
    engine.load_state(hidden);
    r.step = 2;
    r.adam.skip_invisible_semantics = skip;
    engine.step(r);
    const EngineState after = state_of(engine);
    EXPECT_EQ(same_bits(after.model.semantics, hidden.model.semantics), skip);
    EXPECT_FALSE(same_bits(after.model.sh, hidden.model.sh));  // colours go on with their momentum
  }
}

TEST(CpuEngine, ShapeLimitsHoldAfterAStep) {
  const RandomSceneOptions o;
  CpuEngine engine(1);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  r.limits = {0.2f, 6.0f, 0.15f};
  engine.step(r);
  GaussianModel m;
  engine.store(m);
  for (size_t i = 0; i < m.size(); ++i) {
    float s[3] = {std::exp(m.log_scales[3 * i]), std::exp(m.log_scales[3 * i + 1]), std::exp(m.log_scales[3 * i + 2])};
    std::sort(s, s + 3);
    EXPECT_LE(s[2], 0.15f * 1.0001f);
    EXPECT_LE(s[0], 0.2f * s[1] * 1.0001f);
    EXPECT_LE(s[2], 6.0f * s[1] * 1.0001f);
  }
}

TEST(CpuEngine, RenderingMatchesTheReference) {
  const RandomSceneOptions o;
  const GaussianModel model = make_model(o);
  CpuEngine engine(2);
  engine.load(model);
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    RenderOptions options;
    options.labels = true;
    options.semantic_blend = blend;
    const Camera camera = make_camera(61, 43);
    const Rendering got = engine.render(camera, options);
    const Rendering want = reference::render<double>(to_double(model), camera, options);
    const auto close = [](const ImageF& a, const ImageF& b, double tolerance, const char* what) {
      const Difference d = difference(a.data, b.data);
      EXPECT_LE(d.worst, tolerance) << what << " at " << d.at;
    };
    close(got.color, want.color, 2e-5, "colour");
    close(got.alpha, want.alpha, 2e-5, "alpha");
    close(got.normal, want.normal, 1e-4, "normal");
    close(got.depth_plane, want.depth_plane, 1e-3, "plane depth");
    close(got.depth_median, want.depth_median, 1e-3, "median depth");
    close(got.depth_expected, want.depth_expected, 1e-3, "expected depth");
    close(got.label_probability, want.label_probability, 1e-4, "label probability");
    size_t different = 0;
    for (size_t u = 0; u < got.label.data.size(); ++u) different += got.label.data[u] != want.label.data[u];
    EXPECT_LE(different, 1u);  // a tie of two classes or an alpha of 0.5 may fall either way
  }
}

TEST(CpuEngine, LiftGivesEachRowTheTeacherItSees) {
  const RandomSceneOptions o;
  GaussianModel model = make_model(o);
  std::fill(model.semantics.begin(), model.semantics.end(), 0.0f);
  CpuEngine engine(2);
  engine.load(model);
  const std::vector<TrainingView> views = two_views(o);
  engine.set_training_views(views);
  const RasterSettings raster;
  engine.lift_semantics(raster);
  GaussianModel lifted;
  engine.store(lifted);

  // The same in double, from the reference's contributions.
  std::vector<double> sums(model.size() * o.channels, 0.0);
  std::vector<uint8_t> seen(model.size(), 0);
  for (const TrainingView& view : views) {
    const auto splats = reference::make_splats(to_double(model), view.data.camera, raster, model.sh_degree);
    std::vector<reference::Contribution<double>> list;
    std::vector<float> teacher(o.channels);
    for (int y = 0; y < o.height; ++y) {
      for (int x = 0; x < o.width; ++x) {
        const TeacherTaps taps = teacher_taps(view.data.semantics, x, y, o.width, o.height);
        double left;
        reference::blend_pixel(splats, x, y, raster, list, left);
        if (!semantic_pixel_valid(view.data, taps, x, y)) continue;
        sample_teacher(view.data.semantics, taps, teacher.data());
        for (const auto& k : list) {
          seen[k.row] = 1;
          for (int c = 0; c < o.channels; ++c) sums[k.row * o.channels + c] += k.weight * teacher[c];
        }
      }
    }
  }
  size_t unseen = 0;
  for (size_t i = 0; i < model.size(); ++i) {
    double mass = 0, mean = 0;
    for (int c = 0; c < o.channels; ++c) mass += sums[i * o.channels + c];
    const double epsilon = 0.01 + 0.002 * mass;
    for (int c = 0; c < o.channels; ++c) mean += std::log(sums[i * o.channels + c] + epsilon) / o.channels;
    unseen += seen[i] == 0;
    for (int c = 0; c < o.channels; ++c) {
      const double want = seen[i] ? std::log(sums[i * o.channels + c] + epsilon) - mean : 0.0;
      ASSERT_NEAR(lifted.semantics[i * o.channels + c], want, 2e-4) << "row " << i << " class " << c;
    }
  }
  EXPECT_GT(unseen, 0u);
  EXPECT_LT(unseen, model.size() / 2);
}

TEST(CpuEngine, ColoursOfHigherDegreeRestUntilTheyAreUsed) {
  const RandomSceneOptions o;
  CpuEngine engine(1);
  const GaussianModel before = make_model(o);
  engine.load(before);
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  r.sh_degree = 0;
  engine.step(r);
  GaussianModel after;
  engine.store(after);
  EXPECT_EQ(after.sh_degree, 0);
  for (size_t i = 0; i < after.size(); ++i) {
    for (int k = 3; k < 48; ++k) ASSERT_EQ(after.sh[48 * i + k], before.sh[48 * i + k]);
  }
}

TEST(CpuEngine, MisuseIsAnError) {
  const RandomSceneOptions o;
  CpuEngine engine(1);
  GaussianModel model = make_model(o);
  engine.load(model);
  EXPECT_THROW(engine.step(make_request()), Error);  // no views
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  r.view = 1;
  EXPECT_THROW(engine.step(r), Error);
  r = make_request();
  r.adam.epsilon = 0;
  EXPECT_THROW(engine.step(r), Error);
  r = make_request();
  r.rates.scale = kNan;
  EXPECT_THROW(engine.step(r), Error);
  model.sh.pop_back();
  EXPECT_THROW(engine.load(model), Error);
  RestructurePlan plan;
  plan.rows.resize(1);
  plan.rows[0].source = 100000;
  EXPECT_THROW(engine.restructure(plan), Error);
}

TEST(CpuEngine, PredictedBytesCoverTheModelAndGrow) {
  CpuEngine engine(1);
  const uint64_t small = engine.predicted_bytes(1000, 150, 320 * 240),
                 large = engine.predicted_bytes(2000, 150, 320 * 240);
  EXPECT_GT(large - small, 1000u * (59 + 150) * 3 * sizeof(float));
  EXPECT_GT(engine.predicted_bytes(1000, 150, 640 * 480), small);
  EXPECT_LT(engine.predicted_bytes(1000, 0, 320 * 240), small);
}

}  // namespace
}  // namespace aligngs::cpu
