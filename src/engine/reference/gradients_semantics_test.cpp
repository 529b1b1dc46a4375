// Finite differences in double: the semantic loss through both blends into the rows, and its coupling, plain and
// bounded, into opacity, mean and covariance.
#include <gtest/gtest.h>

#include "engine/reference/testing/gradient_scene.h"
#include "scene/semantic_target.h"

namespace aligngs::reference {
namespace {

using namespace testing_scene;

struct Mode {
  const char* name;
  SemanticBlend blend;
  SemanticCoupling coupling;
};
const Mode kModes[] = {{"LogitsPlain", SemanticBlend::kLogits, SemanticCoupling::kPlain},
                       {"LogitsBounded", SemanticBlend::kLogits, SemanticCoupling::kBounded},
                       {"ProbabilitiesPlain", SemanticBlend::kProbabilities, SemanticCoupling::kPlain},
                       {"ProbabilitiesBounded", SemanticBlend::kProbabilities, SemanticCoupling::kBounded},
                       {"LogitsOpacity", SemanticBlend::kLogits, SemanticCoupling::kOpacity},
                       {"ProbabilitiesOpacity", SemanticBlend::kProbabilities, SemanticCoupling::kOpacity}};

StepRequest semantic_request(const Mode& mode) {
  StepRequest r = make_request();
  r.losses.weight[Loss::kSemanticSoft] = 1.0f;
  r.losses.weight[Loss::kSemanticHard] = 0.25f;
  r.losses.semantic_blend = mode.blend;
  r.losses.coupling = mode.coupling;
  r.losses.coupling_strength = 0.5f;
  return r;
}

/// omega varies over the image, as the confidence of a teacher does.
TrainingView weighted_view() {
  TrainingView v = make_view();
  v.semantic_weight = ImageF(kWidth, kHeight, 1);
  for (size_t u = 0; u < v.semantic_weight.pixels(); ++u) {
    v.semantic_weight.data[u] = 0.5f + 0.5f * std::sin(0.3f * u);
  }
  return v;
}

double semantic_loss(const Model& model, const TrainingView& view, const StepRequest& request) {
  return gradients(model, view, request, 0.0, no_map_loss()).losses.total;
}

/// The surrogate of a balanced coupling written out once more, with A of the unmoved model (it is detached).
double surrogate(const Model& model, const TrainingView& view, const StepRequest& request,
                 const std::vector<double>& detached_alpha) {
  const bool probabilities = request.losses.semantic_blend == SemanticBlend::kProbabilities;
  const Splats<double> s = make_splats(model, view.data.camera, request.raster, request.sh_degree);
  std::vector<double> map =
      render_semantics(s, semantic_features(model, request.losses.semantic_blend), kChannels, request.raster);
  const bool opacity = request.losses.coupling == SemanticCoupling::kOpacity;
  const std::vector<double> alpha = render_maps(s, request.raster).alpha;
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const size_t u = size_t(y) * kWidth + x;
      const TeacherTaps taps = teacher_taps(view.data.semantics, x, y, kWidth, kHeight);
      if (taps.valid && opacity) sum -= view.semantic_weight.data[u] * alpha[u];
      if (!taps.valid || opacity || detached_alpha[u] < 0.5) continue;
      float t[kChannels];
      sample_teacher(view.data.semantics, taps, t);
      double* q = &map[u * kChannels];
      if (!probabilities) softmax(q, kChannels, q);
      for (int c = 0; c < kChannels; ++c) {
        const double e = (probabilities ? q[c] / detached_alpha[u] : q[c]) - t[c];
        sum += 0.5 * view.semantic_weight.data[u] * e * e;
      }
    }
  }
  return sum / static_cast<double>(count_semantic_pixels(view.data));
}

class SemanticGradient : public testing::TestWithParam<Mode> {};

TEST_P(SemanticGradient, RowsMatchDifferences) {
  const Model model = make_model<double>();
  const TrainingView view = weighted_view();
  const StepRequest request = semantic_request(GetParam());
  const Gradients<double> g = gradients(model, view, request, 0.7, no_map_loss());
  const ParameterClass& rows = parameter_classes().back();
  const Comparison found =
      compare(rows, model, g.gradient, [&](const Model& m) { return semantic_loss(m, view, request); });
  EXPECT_GT(found.largest, 1e-4);
  EXPECT_LT(found.worst, 2e-6) << found.where;
}

TEST_P(SemanticGradient, CouplingMatchesDifferencesOfItsLoss) {
  const Model model = make_model<double>();
  const TrainingView view = weighted_view();
  const StepRequest request = semantic_request(GetParam());
  const Gradients<double> g = gradients(model, view, request, 0.7, no_map_loss());
  const Splats<double> s = make_splats(model, view.data.camera, request.raster, request.sh_degree);
  const std::vector<double> alpha = render_maps(s, request.raster).alpha;
  const bool bounded = is_balanced(request.losses.coupling);
  EXPECT_NEAR(g.coupling_value, bounded ? surrogate(model, view, request, alpha) : 0.0, 1e-12);
  for (const ParameterClass& c : parameter_classes()) {
    if (c.values == &Model::sh || c.values == &Model::semantics) continue;
    const Comparison found = compare(c, model, g.coupling, [&](const Model& m) {
      return bounded ? surrogate(m, view, request, alpha) : semantic_loss(m, view, request);
    });
    EXPECT_GT(found.largest, 1e-5) << c.name;  // it reaches opacity, mean and covariance
    EXPECT_LT(found.worst, 2e-6) << found.where;
  }
}

TEST_P(SemanticGradient, StrengthScalesTheCouplingAndNothingElse) {
  const Model model = make_model<double>();
  const TrainingView view = weighted_view();
  StepRequest request = semantic_request(GetParam());
  const bool bounded = is_balanced(request.losses.coupling);
  const double scale = 0.25;
  request.losses.coupling_strength = float(scale);
  const Gradients<double> g = gradients(model, view, request, scale, no_map_loss());
  EXPECT_EQ(g.coupling_scale, scale);
  for (size_t k = 0; k < model.positions.size(); ++k) {
    EXPECT_DOUBLE_EQ(g.gradient.positions[k], scale * g.coupling.positions[k]);
  }
  request.losses.coupling_strength = 0;
  const Gradients<double> off = gradients(model, view, request, bounded ? 0.0 : 1.0, no_map_loss());
  const std::vector<double> zero3(model.positions.size(), 0.0);
  EXPECT_EQ(off.gradient.positions, zero3);
  EXPECT_EQ(off.gradient.log_scales, zero3);
  EXPECT_EQ(off.gradient.rotations, std::vector<double>(model.rotations.size(), 0.0));
  EXPECT_EQ(off.gradient.opacity_logits, std::vector<double>(model.size(), 0.0));
  EXPECT_EQ(off.gradient.semantics, g.gradient.semantics);
  EXPECT_EQ(off.losses.total, g.losses.total);
}

INSTANTIATE_TEST_SUITE_P(Gradients, SemanticGradient, testing::ValuesIn(kModes),
                         [](const auto& mode) { return std::string(mode.param.name); });

/// The terms and their gradients are sums over pixels, so the parts of a sample add up to the whole.
TEST_P(SemanticGradient, PhasesOfASampleAverageToAllPixels) {
  const Model model = make_model<double>();
  const TrainingView view = weighted_view();
  StepRequest request = semantic_request(GetParam());
  const Gradients<double> all = gradients(model, view, request, 0.7, no_map_loss());
  for (const int quarters : {2, 1}) {
    const int phases = 4 / quarters;
    double loss = 0, value = 0;
    std::vector<double> rows(all.gradient.semantics.size(), 0.0), opacities(all.coupling.opacity_logits.size(), 0.0);
    for (int phase = 0; phase < phases; ++phase) {
      request.losses.semantic_sample = {quarters, phase, 2};
      const Gradients<double> part = gradients(model, view, request, 0.7, no_map_loss());
      loss += part.losses.total / phases;
      value += part.coupling_value / phases;
      for (size_t k = 0; k < rows.size(); ++k) rows[k] += part.gradient.semantics[k] / phases;
      for (size_t k = 0; k < opacities.size(); ++k) opacities[k] += part.coupling.opacity_logits[k] / phases;
    }
    EXPECT_NEAR(loss, all.losses.total, 1e-12);
    EXPECT_NEAR(value, all.coupling_value, 1e-12);
    for (size_t k = 0; k < rows.size(); ++k) EXPECT_NEAR(rows[k], all.gradient.semantics[k], 1e-12);
    for (size_t k = 0; k < opacities.size(); ++k) EXPECT_NEAR(opacities[k], all.coupling.opacity_logits[k], 1e-12);
  }
}

TEST(SemanticLoss, UnknownTeacherPixelsDropOutOfTheMean) {
  const Model model = make_model<double>();
  TrainingView view = make_view();
  const StepRequest request = semantic_request(kModes[2]);
  // The corner is 2 x 2 of 8 x 6 teacher pixels: at most 4 x 4 of the image.
  const size_t valid = count_semantic_pixels(view.data);
  EXPECT_LT(valid, size_t(kWidth) * kHeight);
  EXPECT_GE(valid, size_t(kWidth) * kHeight - 16);
  const double before = semantic_loss(model, view, request);
  for (int c = 0; c < kChannels; ++c) view.data.semantics.probabilities[c] = float_to_half(c == 2 ? 1.0f : 0.0f);
  EXPECT_EQ(semantic_loss(model, view, request), before) << "an unknown teacher pixel has a say";
}

TEST(SemanticLoss, MaskedPixelsDropOut) {
  const Model model = make_model<double>();
  TrainingView view = make_view();
  const size_t all = count_semantic_pixels(view.data);
  view.data.mask = ImageF(kWidth, kHeight, 1, 1.0f);
  EXPECT_EQ(count_semantic_pixels(view.data), all);
  view.data.mask = ImageF(kWidth, kHeight, 1, 0.0f);
  const Gradients<double> g = gradients(model, view, semantic_request(kModes[2]), 0.0, no_map_loss());
  EXPECT_EQ(g.losses.total, 0.0);
  EXPECT_EQ(g.gradient.semantics, std::vector<double>(model.semantics.size(), 0.0));
}

TEST(SemanticLoss, TeacherOfOtherClassCountIsNoTeacher) {
  Model model = make_model<double>();
  model.semantic_channels = 3;
  model.semantics.assign(3 * model.size(), 0.5);
  const Gradients<double> g = gradients(model, make_view(), semantic_request(kModes[0]), 0.0, no_map_loss());
  EXPECT_EQ(g.losses.total, 0.0);
}

/// A perfect student has no bounded coupling, whatever its opacity; the plain gradient still pushes opacity up.
TEST(SemanticLoss, BoundedCouplingRestsOnCorrectPixels) {
  Model model = make_model<double>();
  TrainingView view = make_view();
  float certain[kChannels] = {0.5f, 0.125f, 0.125f, 0.125f, 0.125f};
  for (size_t k = 0; k < view.data.semantics.probabilities.size(); ++k) {
    view.data.semantics.probabilities[k] = float_to_half(certain[k % kChannels]);
  }
  normalise_target(view.data.semantics);
  for (size_t k = 0; k < model.semantics.size(); ++k) model.semantics[k] = std::log(double(certain[k % kChannels]));
  const Gradients<double> bounded = gradients(model, view, semantic_request(kModes[3]), 1.0, no_map_loss());
  const Gradients<double> plain = gradients(model, view, semantic_request(kModes[2]), 1.0, no_map_loss());
  for (size_t i = 0; i < model.size(); ++i) {
    EXPECT_NEAR(bounded.coupling.opacity_logits[i], 0.0, 1e-12);
  }
  double sum = 0;
  for (double v : plain.coupling.opacity_logits) sum += v;
  EXPECT_LT(sum, -1e-3);
}

TEST(CouplingBalance, FollowsTheRatioOfTheTwoGradients) {
  CouplingBalance balance;
  EXPECT_EQ(coupling_factor(0.1, balance), 0.0);  // nothing known yet
  update_coupling_balance(2.0, 0.0, balance);     // a view without semantics says nothing
  EXPECT_EQ(coupling_factor(0.1, balance), 0.0);
  update_coupling_balance(2.0, 0.5, balance);
  EXPECT_DOUBLE_EQ(coupling_factor(0.1, balance), 0.1 * 2.0 / 0.5);
  update_coupling_balance(4.0, 0.5, balance);
  EXPECT_DOUBLE_EQ(coupling_factor(0.1, balance), 0.1 * (0.9 * 2.0 + 0.1 * 4.0) / 0.5);
  update_coupling_balance(std::nan(""), 0.5, balance);
  EXPECT_DOUBLE_EQ(coupling_factor(0.1, balance), 0.1 * 2.2 / 0.5);
}

/// With the factor from this step's own values the scaled coupling has the asked share of the photometric RMS.
TEST(CouplingBalance, FactorGivesTheAskedShare) {
  const Model model = make_model<double>();
  const TrainingView view = weighted_view();
  const StepRequest request = semantic_request(kModes[3]);
  const MapLossFunction<double> color = [](const RenderMaps<double>& m, LossTerms&, MapGradients<double>& g) {
    for (size_t k = 0; k < m.color.size(); ++k) g.color[k] = std::sin(0.37 * k);
  };
  const Gradients<double> g = gradients(model, view, request, 0.0, color);
  CouplingBalance balance;
  update_coupling_balance(g.photometric_rms, g.coupling_rms, balance);
  const double factor = coupling_factor(0.1, balance);
  double square = 0;
  for (const Vec2d& m : g.coupling_mean) square += factor * factor * (m.x * m.x + m.y * m.y);
  EXPECT_NEAR(std::sqrt(square / g.visible), 0.1 * g.photometric_rms, 1e-12);
}

}  // namespace
}  // namespace aligngs::reference
