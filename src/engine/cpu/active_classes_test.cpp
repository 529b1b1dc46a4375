// Classes carried as one remainder against the same engine with a channel for every class.
#include "engine/cpu/active_classes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/cpu/test_scenes.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/formulas/teacher_sampling.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

constexpr int kActive = 9;  ///< classes that the teacher shows: 3, 7, 11, ... of many
uint16_t active_class(int i, int channels) { return static_cast<uint16_t>(channels < 40 ? i : 3 + 4 * i); }

/// A teacher that mixes two active classes in smooth regions; the rest of its mass lies on the inactive classes, evenly
/// or with `uneven` as chance has it.
TrainingView teacher_view(const SceneOptions& o, bool uneven, double rest = 0.1) {
  Random random(o.seed + 7);
  TrainingView v = make_view(o);
  SemanticTarget& t = v.data.semantics;
  const size_t channels = static_cast<size_t>(o.channels);
  for (int i = 0; i < t.width * t.height; ++i) {
    const int region = (i % t.width) * 3 / t.width + 3 * ((i / t.width) * 3 / t.height);
    const uint16_t first = active_class(region, o.channels), second = active_class((region + 1) % kActive, o.channels);
    const double share = random.uniform(0.6, 0.9);
    std::vector<double> p(channels);
    double sum = 0;
    for (double& x : p) sum += x = uneven ? random.uniform(0.0, 1.0) : 1.0;
    for (int k = 0; k < kActive; ++k) {
      sum -= p[active_class(k, o.channels)];
      p[active_class(k, o.channels)] = 0;
    }
    for (double& x : p) x *= rest / sum;
    p[first] += (1 - rest) * share;
    p[second] += (1 - rest) * (1 - share);
    for (size_t c = 0; c < channels; ++c) t.probabilities[i * channels + c] = float_to_half(static_cast<float>(p[c]));
  }
  return v;
}

std::vector<uint8_t> active_flags(int channels) {
  std::vector<uint8_t> active(static_cast<size_t>(channels), 0);
  for (int k = 0; k < kActive; ++k) active[active_class(k, channels)] = 1;
  return active;
}

/// A model whose rows hold one number for all inactive classes.
GaussianModel model_with_remainder(const SceneOptions& o) {
  GaussianModel m = make_model(o);
  for (size_t i = 0; i < m.size(); ++i) {
    float* row = &m.semantics[i * static_cast<size_t>(o.channels)];
    const float rest = row[0];
    const std::vector<uint8_t> active = active_flags(o.channels);
    for (int c = 0; c < o.channels; ++c) row[c] = active[static_cast<size_t>(c)] != 0 ? row[c] : rest;
  }
  return m;
}

SceneOptions options(int channels) {
  SceneOptions o;
  o.channels = channels;
  o.gaussians = 200;
  return o;
}

void prepare(CpuEngine& engine, int top_k, const GaussianModel& model, const TrainingView& view,
             SemanticProducts products = SemanticProducts::kFloat32) {
  engine.set_semantic_products(products);
  engine.limit_classes(top_k);
  engine.load(model);
  engine.set_training_views({view});
  engine.set_coupling_balance({2e-4, 1e-3});
}

TEST(ActiveClasses, AreThoseThatSomePixelRanksAmongItsTopTwo) {
  ThreadPool pool(2);
  const SceneOptions o = options(40);
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
  const SceneOptions o = options(kActive + 1);  // one inactive class would become a remainder of one
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
}

/// With equal teachers and equal logits among the inactive classes, nothing is lost: losses and gradients are those of
/// all classes within float rounding; the remainder's row gradient is the sum of its classes'.
TEST(ActiveClasses, StepEqualsThatOfAllClasses) {
  for (const int channels : {40, 150, 151}) {
    const SceneOptions o = options(channels);
    const GaussianModel model = model_with_remainder(o);
    const TrainingView view = teacher_view(o, false);
    for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
      for (const SemanticCoupling coupling : {SemanticCoupling::kBounded, SemanticCoupling::kPlain}) {
        SCOPED_TRACE(testing::Message() << channels << " classes, blend " << int(blend) << ", coupling "
                                        << int(coupling));
        StepRequest r = make_request();
        r.losses.semantic_blend = blend;
        r.losses.coupling = coupling;
        CpuEngine all(2), few(2);
        all.keep_features(true);
        few.keep_features(true);
        prepare(all, 0, model, view);
        prepare(few, 2, model, view);
        const StepReport a = all.step(r), b = few.step(r);
        EXPECT_NEAR(b.losses.semantic_soft, a.losses.semantic_soft, 2e-4);  // float16 holds the sum of the rest
        EXPECT_NEAR(b.losses.semantic_hard, a.losses.semantic_hard, 1e-5);
        const GaussianModel ga = all.last_gradients(), gb = few.last_gradients();
        ASSERT_EQ(gb.semantic_channels, kActive + 1);
        EXPECT_LE(difference(gb.opacity_logits, ga.opacity_logits).worst, 1e-3);
        EXPECT_LE(difference(gb.positions, ga.positions).worst, 1e-3);
        EXPECT_LE(difference(gb.log_scales, ga.log_scales).worst, 1e-3);
        ThreadPool pool(1);
        const ActiveClasses map = find_active_classes({view}, 2, pool);
        std::vector<float> want;
        for (size_t i = 0; i < model.size(); ++i) {
          float rest = 0;
          std::vector<float> row(&ga.semantics[i * channels], &ga.semantics[i * channels] + channels);
          for (const uint16_t c : map.active) {
            want.push_back(row[c]);
            row[c] = 0;
          }
          for (const float x : row) rest += x;
          want.push_back(rest);
        }
        EXPECT_LE(difference(gb.semantics, want).worst, 1e-3);
        EXPECT_NEAR(few.coupling_balance().semantic, all.coupling_balance().semantic,
                    1e-3 * all.coupling_balance().semantic);
      }
    }
  }
}

struct LabelCounts {
  size_t labelled = 0, same = 0;
};
LabelCounts compare_labels(const CpuEngine& all, const CpuEngine& few, const TrainingView& view, SemanticBlend blend) {
  RenderOptions options;
  options.labels = true;
  options.semantic_blend = blend;
  const Rendering a = all.render(view.data.camera, options), b = few.render(view.data.camera, options);
  LabelCounts counts;
  for (size_t u = 0; u < a.label.data.size(); ++u) {
    if (a.label.data[u] == kNoLabel) continue;
    ++counts.labelled;
    counts.same += a.label.data[u] == b.label.data[u] ? 1 : 0;
  }
  EXPECT_GT(counts.labelled, a.label.data.size() / 2);
  return counts;
}

/// Four fifths of the teacher's mass, and most of every row's, on classes that no pixel ranks high: together they outweigh
/// every single class, yet the teacher's label and the rendered one are the best single class.
TEST(ActiveClasses, TheRemainderIsNoLabelHoweverMuchItHolds) {
  const SceneOptions o = options(150);
  const TrainingView view = teacher_view(o, false, 0.8);
  const std::vector<uint8_t> active = active_flags(o.channels);
  GaussianModel model = make_model(o);
  for (size_t i = 0; i < model.size(); ++i) {
    float* row = &model.semantics[i * 150];
    double largest = 0, rest = 0;
    for (size_t c = 0; c < 150; ++c) {
      if (active[c] == 0) row[c] = -1;
      const double mass = std::exp(static_cast<double>(row[c]));
      rest += active[c] == 0 ? mass : 0.0;
      largest = std::max(largest, active[c] != 0 ? mass : 0.0);
    }
    ASSERT_GT(rest, largest);
  }
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    SCOPED_TRACE(int(blend));
    CpuEngine all(2), few(2);
    prepare(all, 0, model, view);
    prepare(few, 2, model, view);
    StepRequest r = make_request();
    r.losses.semantic_blend = blend;
    const LabelCounts labels = compare_labels(all, few, view, blend);
    EXPECT_EQ(labels.same, labels.labelled);
    const double hard = all.step(r).losses.semantic_hard;
    EXPECT_NEAR(few.step(r).losses.semantic_hard, hard, 1e-5);
    EXPECT_GT(hard, 2.0);  // nats; were the remainder the label, it would be a few tenths
  }
}

/// Nats that one remainder cannot express of an uneven rest: sum t log t over its classes less the same of their mean, mean
/// over the pixels of the loss.
double unevenness_of(const TrainingView& view) {
  const SemanticTarget& teacher = view.data.semantics;
  const std::vector<uint8_t> active = active_flags(teacher.channels);
  const int width = view.data.camera.width, height = view.data.camera.height;
  std::vector<float> t(static_cast<size_t>(teacher.channels));
  double sum = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const TeacherTaps taps = teacher_taps(teacher, x, y, width, height);
      if (!semantic_pixel_valid(view.data, taps, x, y)) continue;
      sample_teacher(teacher, taps, t.data());
      double rest = 0;
      for (size_t c = 0; c < t.size(); ++c) {
        const double p = static_cast<double>(t[c]);
        if (active[c] != 0 || !(p > 0)) continue;
        rest += p;
        sum += p * std::log(p);
      }
      sum -= rest * std::log(rest / (teacher.channels - kActive));
    }
  }
  return sum / static_cast<double>(count_semantic_pixels(view.data));
}

/// The bounds on which the remainder is on by default (docs/method.md). With an uneven rest of a tenth of the mass, after
/// training, the soft loss of all classes is that of the channels plus the constant that the rest's unevenness is.
constexpr double kSoftAgreement = 0.002;   ///< nats
constexpr double kHardAgreement = 0.002;   ///< nats
constexpr double kSameLabels = 0.995;     ///< of the labelled pixels

TEST(ActiveClasses, TrainingAgreesWithAllClasses) {
  const SceneOptions o = options(150);
  GaussianModel model = make_model(o);
  std::fill(model.semantics.begin(), model.semantics.end(), 0.0f);
  const TrainingView view = teacher_view(o, true);
  const double unevenness = unevenness_of(view);
  EXPECT_GT(unevenness, kSoftAgreement);  // else the agreement would say nothing about it
  RecordProperty("unevenness", std::to_string(unevenness));
  for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
    SCOPED_TRACE(int(blend));
    CpuEngine all(2), few(2);
    prepare(all, 0, model, view, SemanticProducts::kAutomatic);
    prepare(few, 2, model, view, SemanticProducts::kAutomatic);
    StepReport a, b;
    StepRequest r = make_request();
    r.losses.semantic_blend = blend;
    r.rates.semantic = 0.05f;
    all.lift_semantics(r.raster);
    few.lift_semantics(r.raster);
    for (r.step = 1; r.step <= 40; ++r.step) {
      a = all.step(r);
      b = few.step(r);
    }
    const std::string name = blend == SemanticBlend::kProbabilities ? "probabilities" : "logits";
    RecordProperty(name + "_soft", std::to_string(a.losses.semantic_soft - b.losses.semantic_soft - unevenness));
    RecordProperty(name + "_hard", std::to_string(a.losses.semantic_hard - b.losses.semantic_hard));
    EXPECT_NEAR(a.losses.semantic_soft - b.losses.semantic_soft, unevenness, kSoftAgreement);
    EXPECT_NEAR(a.losses.semantic_hard, b.losses.semantic_hard, kHardAgreement);
    const LabelCounts labels = compare_labels(all, few, view, blend);
    const double same = static_cast<double>(labels.same) / static_cast<double>(labels.labelled);
    RecordProperty(name + "_labels", std::to_string(same));
    EXPECT_GE(same, kSameLabels);
  }
}

TEST(ActiveClasses, FilesKeepEveryClassAndResumeBitByBit) {
  const SceneOptions o = options(40);
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
  // What is rendered from the stored rows, where every class has a channel again, is what the engine rendered.
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
  const SceneOptions o = options(40);
  const GaussianModel model = model_with_remainder(o);
  const TrainingView view = teacher_view(o, true);
  CpuEngine before(1), after(1);
  before.limit_classes(2);
  before.set_training_views({view});
  before.load(model);
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
  SceneOptions other = o;
  other.channels = kActive + 1;
  before.load(make_model(other));
  EXPECT_EQ(before.step(make_request()).losses.semantic_soft, 0.0);
}

}  // namespace
}  // namespace aligngs::cpu
