// Steps, labels and training with a remainder beside those of all classes.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/testing/active_class_scenes.h"
#include "engine/formulas/teacher_sampling.h"
#include "engine/shared/active_classes.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

/// With equal teachers and equal logits among the inactive classes, nothing is lost. Losses and gradients are those of
/// all classes within float rounding. The remainder's row gradient is the sum of its classes'. Preset default with
/// matrix tiles runs this: a remainder and rows in bfloat16.
TEST(ActiveClasses, MatrixTilesWithARemainderGiveTheGradientsOfFloat32) {
  if (!matrix_tiles_available()) GTEST_SKIP() << "this processor has no matrix tiles";
  for (const int channels : {40, 150, 151}) {
    const RandomSceneOptions o = options(channels);
    const TrainingView view = teacher_view(o, true);
    for (const SemanticBlend blend : {SemanticBlend::kProbabilities, SemanticBlend::kLogits}) {
      SCOPED_TRACE(testing::Message() << channels << " classes, blend " << int(blend));
      StepRequest r = make_request();
      r.losses.semantic_blend = blend;
      CpuEngine exact(2), rounded(2);
      for (CpuEngine* e : {&exact, &rounded}) e->keep_features(true);
      prepare(exact, 2, model_with_remainder(o), view, SemanticProducts::kFloat32);
      prepare(rounded, 2, model_with_remainder(o), view, SemanticProducts::kBfloat16);
      const StepReport want = exact.step(r), got = rounded.step(r);
      EXPECT_NEAR(got.losses[Loss::kSemanticSoft], want.losses[Loss::kSemanticSoft], 2e-3);
      EXPECT_NEAR(got.losses[Loss::kSemanticHard], want.losses[Loss::kSemanticHard], 2e-3);
      const GaussianModel a = rounded.last_gradients(), b = exact.last_gradients();
      ASSERT_EQ(a.semantic_channels, kActive + 1);
      EXPECT_LE(difference(a.semantics, b.semantics).worst, 1e-2);
      EXPECT_LE(difference(a.opacity_logits, b.opacity_logits).worst, 1e-2);
      EXPECT_LE(difference(a.positions, b.positions).worst, 1e-2);
    }
  }
}

TEST(ActiveClasses, StepEqualsThatOfAllClasses) {
  for (const int channels : {40, 150, 151}) {
    const RandomSceneOptions o = options(channels);
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
        // float16 holds the sum of the rest, of targets that sum to one
        EXPECT_NEAR(b.losses[Loss::kSemanticSoft], a.losses[Loss::kSemanticSoft], 2.5e-4);
        EXPECT_NEAR(b.losses[Loss::kSemanticHard], a.losses[Loss::kSemanticHard], 1e-5);
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

/// Four fifths of the teacher's mass, and most of every row's, on classes that no pixel ranks high: together they
/// outweigh every single class. Yet the teacher's label and the rendered one are the best single class.
TEST(ActiveClasses, TheRemainderIsNoLabelHoweverMuchItHolds) {
  const RandomSceneOptions o = options(150);
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
    const double hard = all.step(r).losses[Loss::kSemanticHard];
    EXPECT_NEAR(few.step(r).losses[Loss::kSemanticHard], hard, 1e-5);
    EXPECT_GT(hard, 2.0);  // nats; were the remainder the label, it would be a few tenths
  }
}

/// Nats of an uneven rest that one remainder cannot express. Mean over the pixels of the loss: sum t log t over its
/// classes, less the same of their mean.
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

/// The bounds on which the remainder is on by default (docs/method.md). The rest is uneven and has a tenth of the mass.
/// After training, the soft loss of all classes is that of the channels plus a constant for the unevenness.
constexpr double kSoftAgreement = 0.002;  ///< nats
constexpr double kHardAgreement = 0.002;  ///< nats
constexpr double kSameLabels = 0.995;     ///< of the labelled pixels

TEST(ActiveClasses, TrainingAgreesWithAllClasses) {
  const RandomSceneOptions o = options(150);
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
    RecordProperty(name + "_soft",
                   std::to_string(a.losses[Loss::kSemanticSoft] - b.losses[Loss::kSemanticSoft] - unevenness));
    RecordProperty(name + "_hard", std::to_string(a.losses[Loss::kSemanticHard] - b.losses[Loss::kSemanticHard]));
    EXPECT_NEAR(a.losses[Loss::kSemanticSoft] - b.losses[Loss::kSemanticSoft], unevenness, kSoftAgreement);
    EXPECT_NEAR(a.losses[Loss::kSemanticHard], b.losses[Loss::kSemanticHard], kHardAgreement);
    const LabelCounts labels = compare_labels(all, few, view, blend);
    const double same = static_cast<double>(labels.same) / static_cast<double>(labels.labelled);
    RecordProperty(name + "_labels", std::to_string(same));
    EXPECT_GE(same, kSameLabels);
  }
}

}  // namespace
}  // namespace aligngs::cpu
