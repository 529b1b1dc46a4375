// The engine as the trainer uses it: steps, state, restructuring, rendering, and what happens when something is wrong.
#include "engine/cpu/cpu_engine.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/error.h"
#include "engine/cpu/test_scenes.h"
#include "engine/formulas/adam.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<TrainingView> two_views(const SceneOptions& o) {
  TrainingView first = make_view(o), second = make_view(o);
  second.data.camera.world_to_camera.translation.x += 0.3;
  return {first, second};
}

/// Steps [first, last] alternate between the views.
void run_steps(Engine& engine, int first, int last) {
  StepRequest r = make_geometry_request();
  for (r.step = first; r.step <= last; ++r.step) {
    r.view = static_cast<int>(r.step % 2);
    ASSERT_FALSE(engine.step(r).non_finite.found);
  }
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

void expect_same_state(const EngineState& a, const EngineState& b) {
  EXPECT_TRUE(same_bits(a.model.positions, b.model.positions));
  EXPECT_TRUE(same_bits(a.model.log_scales, b.model.log_scales));
  EXPECT_TRUE(same_bits(a.model.rotations, b.model.rotations));
  EXPECT_TRUE(same_bits(a.model.opacity_logits, b.model.opacity_logits));
  EXPECT_TRUE(same_bits(a.model.sh, b.model.sh));
  EXPECT_TRUE(same_bits(a.model.semantics, b.model.semantics));
  ASSERT_EQ(a.arrays.size(), b.arrays.size());
  for (const auto& [name, values] : a.arrays) EXPECT_TRUE(same_bits(values, b.arrays.at(name))) << name;
}

EngineState state_of(const Engine& engine) {
  EngineState s;
  engine.save_state(s);
  return s;
}

TEST(CpuEngine, BitIdenticalForAnyNumberOfThreads) {
  SceneOptions o;
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
  const SceneOptions o;
  CpuEngine engine(2);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  const double start = engine.step(r).losses.total;
  double end = start;
  for (r.step = 2; r.step <= 60; ++r.step) end = engine.step(r).losses.total;
  EXPECT_LT(end, 0.8 * start);
}

TEST(CpuEngine, AdamFollowsTheFormula) {
  const SceneOptions o;
  CpuEngine engine(2);
  engine.keep_features(true);
  const GaussianModel before = make_model(o);
  engine.load(before);
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  engine.step(r);
  const GaussianModel gradient = engine.last_gradients();
  GaussianModel after;
  engine.store(after);
  const auto check = [&](const std::vector<float>& p0, const std::vector<float>& g, const std::vector<float>& p1,
                         double rate) {
    const AdamStep<double> step = make_adam_step<double>(r.adam, rate, 1);
    for (size_t i = 0; i < p0.size(); ++i) {
      double want = p0[i], m = 0, v = 0;
      if (std::abs(g[i]) > 0 && std::abs(g[i]) < 1e-12f) continue;  // comparable to epsilon: rounding decides
      adam_update<double>(step, g[i], want, m, v);
      ASSERT_NEAR(p1[i], want, 1e-5 * rate + 1e-6 * std::abs(want)) << i << " gradient " << g[i];
    }
  };
  check(before.positions, gradient.positions, after.positions, r.rates.position);
  check(before.log_scales, gradient.log_scales, after.log_scales, r.rates.scale);
  check(before.rotations, gradient.rotations, after.rotations, r.rates.rotation);
  check(before.opacity_logits, gradient.opacity_logits, after.opacity_logits, r.rates.opacity);
  check(before.semantics, gradient.semantics, after.semantics, r.rates.semantic);
  std::vector<float> dc[3], rest[3];
  const std::vector<float>* sh[3] = {&before.sh, &gradient.sh, &after.sh};
  for (size_t i = 0; i < before.sh.size(); ++i) {
    for (int k = 0; k < 3; ++k) (i % (3 * kShCoefficients) < 3 ? dc : rest)[k].push_back((*sh[k])[i]);
  }
  check(dc[0], dc[1], dc[2], r.rates.sh_dc);
  check(rest[0], rest[1], rest[2], r.rates.sh_rest);
}

TEST(CpuEngine, SemanticRowsAreCorrectedByTheirOwnUpdates) {
  const SceneOptions o;
  CpuEngine engine(2);
  engine.set_semantic_products(SemanticProducts::kFloat32);  // gradients that are not rounded
  engine.keep_features(true);
  const GaussianModel before = make_model(o);
  engine.load(before);
  TrainingView away = make_view(o);
  for (const int axis : {0, 2}) {  // a half turn about the vertical: everything is behind it
    Mat3d& rotation = away.data.camera.world_to_camera.rotation;
    for (int k = 0; k < 3; ++k) rotation(axis, k) = -rotation(axis, k);
  }
  engine.set_training_views({make_view(o), away});
  StepRequest r = make_request();
  r.adam.skip_invisible_semantics = true;
  std::vector<double> want(before.semantics.begin(), before.semantics.end()), m(want.size()), v(want.size());
  std::vector<int> updates(before.size(), 0);
  for (r.step = 1; r.step <= 30; ++r.step) {
    r.view = r.step == 1 || r.step == 30 ? 0 : 1;
    engine.step(r);
    if (r.view == 1) continue;
    const std::vector<float>& gradient = engine.last_gradients().semantics;
    for (size_t i = 0; i < before.size(); ++i) {
      const size_t row = i * static_cast<size_t>(o.channels);
      const bool used = std::any_of(&gradient[row], &gradient[row] + o.channels, [](float g) { return g != 0; });
      if (!used) continue;
      const AdamStep<double> step = make_adam_step<double>(r.adam, r.rates.semantic, ++updates[i]);
      for (size_t c = row; c < row + static_cast<size_t>(o.channels); ++c) {
        adam_update<double>(step, gradient[c], want[c], m[c], v[c]);
      }
    }
  }
  GaussianModel after;
  engine.store(after);
  EXPECT_GT(std::count(updates.begin(), updates.end(), 2), 10);
  for (size_t i = 0; i < want.size(); ++i) {
    ASSERT_NEAR(after.semantics[i], want[i], 1e-3 * r.rates.semantic + 1e-5 * std::abs(want[i])) << i;
  }
}

TEST(CpuEngine, NothingVisibleLeavesTheModelAsItIs) {
  SceneOptions o;
  o.depth_min = -3;
  o.depth_max = -1;  // all behind the camera
  CpuEngine engine(2);
  const GaussianModel before = make_model(o);
  engine.load(before);
  engine.set_training_views({make_view(o)});
  StepRequest r = make_geometry_request();
  r.losses.opacity_l1_weight = r.losses.scale_l1_weight = 0;
  const StepReport report = engine.step(r);
  EXPECT_FALSE(report.non_finite.found) << report.non_finite.term;
  EXPECT_EQ(report.visible, 0u);
  EXPECT_GT(report.losses.l1, 0);
  GaussianModel after;
  engine.store(after);
  EXPECT_TRUE(same_bits(before.positions, after.positions));
  EXPECT_TRUE(same_bits(before.opacity_logits, after.opacity_logits));
  EXPECT_TRUE(same_bits(before.semantics, after.semantics));
}

TEST(CpuEngine, EmptyModelStepsAndRenders) {
  SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
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

TEST(CpuEngine, RestructureCarriesMomentsAndZeroesThoseOfNewRows) {
  const SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
  CpuEngine engine(2);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  StepRequest r = make_request();
  engine.step(r);
  const EngineState before = state_of(engine);
  r.step = 2;
  r.losses.l1_weight = 1e30f;
  const StepReport report = engine.step(r);
  EXPECT_TRUE(report.non_finite.found);
  EXPECT_GE(report.non_finite.gaussian, 0);
  expect_same_state(before, state_of(engine));
}

TEST(CpuEngine, InvisibleSemanticRowsRestWhenAsked) {
  SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
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
  const SceneOptions o;
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
