// Finite differences in double: the terms of the Gaussians themselves, and everything at once.
#include <gtest/gtest.h>

#include "engine/reference/testing/gradient_scene.h"

namespace aligngs::reference {
namespace {

using namespace testing_scene;

void expect_matches(const Model& model, const Gradients<double>& g, const std::function<double(const Model&)>& loss) {
  for (const ParameterClass& c : parameter_classes()) {
    const Comparison found = compare(c, model, g.gradient, loss);
    EXPECT_LT(found.worst, 2e-6) << found.where;
  }
}

TEST(ShapeTerms, FlatteningMatchesDifferences) {
  const Model model = make_model<double>();
  StepRequest request = make_request();
  request.losses.weight[Loss::kFlatten] = 100;
  const auto loss = [&](const Model& m) { return gradients(m, make_view(), request, 0.0, no_map_loss()).losses.total; };
  const Gradients<double> g = gradients(model, make_view(), request, 0.0, no_map_loss());
  double mean = 0;  // all eight are visible
  for (size_t i = 0; i < model.size(); ++i) {
    mean += std::exp(*std::min_element(&model.log_scales[3 * i], &model.log_scales[3 * i] + 3)) / 8;
  }
  EXPECT_NEAR(g.losses[Loss::kFlatten], mean / request.extent, 1e-12);
  expect_matches(model, g, loss);
}

TEST(ShapeTerms, FlatteningAveragesOverVisibleGaussiansOnly) {
  Model model = make_model<double>();
  for (int k = 0; k < 3; ++k) model.positions[k] += 100;  // far outside the image
  StepRequest request = make_request();
  request.losses.weight[Loss::kFlatten] = 100;
  const Gradients<double> g = gradients(model, make_view(), request, 0.0, no_map_loss());
  EXPECT_EQ(g.visible, 7u);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(g.gradient.log_scales[k], 0.0);
}

TEST(ShapeTerms, OpacityAndScaleRegularisersMatchDifferences) {
  const Model model = make_model<double>();
  StepRequest request = make_request();
  request.losses.weight[Loss::kOpacityL1] = 0.7f;
  request.losses.weight[Loss::kScaleL1] = 1.3f;
  const Gradients<double> g = gradients(model, make_view(), request, 0.0, no_map_loss());
  EXPECT_GT(g.losses[Loss::kOpacityL1], 0);
  EXPECT_GT(g.losses[Loss::kScaleL1], 0);
  expect_matches(model, g,
                 [&](const Model& m) { return gradients(m, make_view(), request, 0.0, no_map_loss()).losses.total; });
}

/// Photometric probe, semantic loss with the plain coupling at strength 1, and all shape terms: the whole gradient is
/// that of the total.
TEST(ShapeTerms, TheWholeGradientIsThatOfTheTotal) {
  const Model model = make_model<double>();
  StepRequest request = make_request();
  request.losses.weight[Loss::kFlatten] = 100;
  request.losses.weight[Loss::kOpacityL1] = 0.01f;
  request.losses.weight[Loss::kScaleL1] = 0.01f;
  request.losses.weight[Loss::kSemanticSoft] = 1;
  request.losses.weight[Loss::kSemanticHard] = 0.1f;
  request.losses.coupling = SemanticCoupling::kPlain;
  request.losses.coupling_strength = 1;
  const MapLossFunction<double> color = [](const RenderMaps<double>& m, LossTerms& terms, MapGradients<double>& d) {
    for (size_t k = 0; k < m.color.size(); ++k) {
      terms.total += std::sin(0.37 * k) * m.color[k];
      d.color[k] += std::sin(0.37 * k);
    }
  };
  for (SemanticBlend blend : {SemanticBlend::kLogits, SemanticBlend::kProbabilities}) {
    request.losses.semantic_blend = blend;
    const Gradients<double> g = gradients(model, make_view(), request, 0.0, color);
    expect_matches(model, g,
                   [&](const Model& m) { return gradients(m, make_view(), request, 0.0, color).losses.total; });
  }
}

}  // namespace
}  // namespace aligngs::reference
