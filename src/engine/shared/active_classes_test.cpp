// The choice of the classes that become the remainder; rows, teachers and files go to and from it.
#include "engine/shared/active_classes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/cpu/testing/active_class_scenes.h"
#include "scene/semantic_target.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

TEST(ActiveClasses, AreThoseThatSomePixelRanksAmongItsTopTwo) {
  ThreadPool pool(2);
  const RandomSceneOptions o = options(40);
  TrainingView view = teacher_view(o, true);
  const ActiveClasses map = find_active_classes({view}, 2, pool);
  std::vector<uint16_t> want;
  for (int k = 0; k < kActive; ++k) want.push_back(active_class(k, o.channels));
  std::sort(want.begin(), want.end());
  EXPECT_EQ(map.active, want);
  EXPECT_EQ(map.classes, 40);
  EXPECT_EQ(map.channels(), kActive + 1);
  EXPECT_EQ(map.remainder(), 40 - kActive);
  // A third rank falls to classes by chance.
  EXPECT_GT(find_active_classes({view}, 3, pool).channels(), kActive + 1);
  // Pixels without confidence say nothing.
  for (float& c : view.data.semantics.confidence) c = 0;
  EXPECT_FALSE(find_active_classes({view}, 2, pool).has_remainder());
}

TEST(ActiveClasses, AllClassesAreChannelsWhenThereIsNothingToGain) {
  ThreadPool pool(1);
  const RandomSceneOptions o = options(kActive + 1);  // one inactive class would become a remainder of one
  EXPECT_FALSE(find_active_classes({teacher_view(o, false)}, 2, pool).has_remainder());
  EXPECT_FALSE(find_active_classes({teacher_view(options(40), false)}, 0, pool).has_remainder());
  EXPECT_FALSE(find_active_classes({}, 2, pool).has_remainder());
  EXPECT_FALSE(find_active_classes({teacher_view(options(40), false), teacher_view(options(41), false)}, 2, pool)
                   .has_remainder());
}

TEST(ActiveClasses, RowsComeBackBitByBitAndUnequalOnesKeepTheirMass) {
  ActiveClasses map;
  map.classes = 5;
  map.active = {1, 3};
  const std::vector<float> compact = {0.1f, -2.3f, 0.7f, 5.0f, 6.0f, -7.1f};
  const std::vector<float> full = expand_rows(map, compact);
  EXPECT_EQ(full, (std::vector<float>{0.7f, 0.1f, 0.7f, -2.3f, 0.7f, -7.1f, 5.0f, -7.1f, 6.0f, -7.1f}));
  EXPECT_EQ(compress_rows(map, RowKind::kLogits, full), compact);
  EXPECT_EQ(compress_rows(map, RowKind::kMoments, full), compact);
  const std::vector<float> uneven = {1, 0, 2, 0, 4};
  const float r = compress_rows(map, RowKind::kLogits, uneven)[2];
  EXPECT_NEAR(3 * std::exp(r), std::exp(1.0f) + std::exp(2.0f) + std::exp(4.0f), 1e-4);
  EXPECT_NEAR(compress_rows(map, RowKind::kMoments, uneven)[2], 7.0f / 3, 1e-6);
}

TEST(ActiveClasses, TargetKeepsTheActiveProbabilitiesAndTheSumOfTheRest) {
  ThreadPool pool(1);
  SemanticTarget t;
  t.channels = 4;
  t.width = t.height = 1;
  for (const float p : {0.125f, 0.5f, 0.25f, 0.125f}) t.probabilities.push_back(float_to_half(p));
  ActiveClasses map;
  map.classes = 4;
  map.active = {1, 2};
  compress_target(map, pool, t);
  ASSERT_EQ(t.channels, 3);
  EXPECT_EQ(half_to_float(t.probabilities[0]), 0.5f);
  EXPECT_EQ(half_to_float(t.probabilities[1]), 0.25f);
  EXPECT_EQ(half_to_float(t.probabilities[2]), 0.25f);
  EXPECT_EQ(t.scale, std::vector<float>{1});
}

TEST(ActiveClasses, ACompactTargetSumsToOneAgain) {
  ThreadPool pool(1);
  std::vector<float> scores(150, 0.0f);
  scores[7] = 1;
  SemanticTarget t = semantic_target(scores.data(), 150, 1, 1, {SemanticKind::kLogits, 1});
  ActiveClasses map;
  map.classes = 150;
  map.active = {7, 8};
  compress_target(map, pool, t);
  double sum = 0;
  for (const uint16_t p : t.probabilities) sum += static_cast<double>(t.scale[0] * half_to_float(p));
  EXPECT_NEAR(sum, 1, 1e-6);
}

TEST(ActiveClasses, FilesKeepEveryClassAndResumeBitByBit) {
  const RandomSceneOptions o = options(40);
  const TrainingView view = teacher_view(o, true);
  CpuEngine engine(2);
  prepare(engine, 2, make_model(o), view);
  StepRequest r = make_request();
  engine.lift_semantics(r.raster);
  for (r.step = 1; r.step <= 3; ++r.step) engine.step(r);
  GaussianModel stored;
  engine.store(stored);
  EXPECT_EQ(stored.semantic_channels, 40);
  EXPECT_EQ(stored.semantics.size(), stored.size() * 40);
  EngineState state;
  engine.save_state(state);
  EXPECT_EQ(state.arrays.at("adam_m.semantics").size(), stored.size() * 40);
  CpuEngine resumed(1);
  prepare(resumed, 2, make_model(o), view);
  resumed.load_state(state);
  engine.step(r);
  resumed.step(r);
  GaussianModel a, b;
  engine.store(a);
  resumed.store(b);
  EXPECT_EQ(a.semantics, b.semantics);
  EXPECT_EQ(a.positions, b.positions);
  // The stored rows, where every class has a channel again, give the engine's own rendering.
  CpuEngine viewer(1);
  viewer.load(a);
  RenderOptions options;
  options.labels = true;
  const Rendering want = engine.render(view.data.camera, options), got = viewer.render(view.data.camera, options);
  size_t different = 0;
  for (size_t u = 0; u < want.label.data.size(); ++u) different += want.label.data[u] != got.label.data[u];
  EXPECT_LE(different, 1u);
}

TEST(ActiveClasses, ViewsMayComeBeforeOrAfterTheModel) {
  const RandomSceneOptions o = options(40);
  const GaussianModel model = model_with_remainder(o);
  const TrainingView view = teacher_view(o, true);
  CpuEngine before(1), after(1);
  before.prepare({{view}, 2, &model});
  prepare(after, 2, model, view);
  before.set_coupling_balance({2e-4, 1e-3});
  before.set_semantic_products(SemanticProducts::kFloat32);
  before.step(make_request());
  after.step(make_request());
  GaussianModel a, b;
  before.store(a);
  after.store(b);
  EXPECT_EQ(a.semantics, b.semantics);
  // A model of another number of classes trains without semantics, whatever the number of channels is.
  RandomSceneOptions other = o;
  other.channels = kActive + 1;
  before.load(make_model(other));
  EXPECT_EQ(before.step(make_request()).losses[Loss::kSemanticSoft], 0.0);
}

}  // namespace
}  // namespace aligngs::cpu
