// One step of the engine against the scalar reference in double precision: maps, losses, every gradient and statistic.
#pragma once

#include "engine/cpu/simd_targets.h"

#include <gtest/gtest.h>

#include "engine/cpu/testing/products.h"
#include "engine/testing/scenes.h"

namespace aligngs::cpu::testing_scene {

/// Tolerances, relative to the largest entry of a map or of a class of gradients. A mean of a few hundred pixels has an
/// ulp of 3e-5 pixels. It moves the alpha of a splat of one pixel's size by 1e-4 of itself.
struct Tolerance {
  double map = 2e-5;
  double loss = 2e-5;
  double gradient = 2e-4;
  double statistic = 5e-4;
  double semantic_loss = 2e-5;      ///< nats
  double semantic_gradient = 2e-4;  ///< of the semantic rows
  double coupling = 0;              ///< of gradients that the semantic loss reaches, beside `gradient`
  double bfloat16_coupling = 2e-3;  ///< the same with bfloat16 products
  double bfloat16_rows = 5e-3;      ///< `semantic_gradient` with bfloat16 products
};

/// For bfloat16 products whose coupling makes up most of the shape's gradient: as close as the semantic rows.
inline Tolerance of_coupling_alone() {
  Tolerance t;
  t.bfloat16_coupling = t.bfloat16_rows;
  return t;
}

/// bfloat16 operands have 8 significant bits: 2^-9 relative per term of a product, of which hundreds are summed.
inline Tolerance with_bfloat16(Tolerance t) {
  t.semantic_loss = 2e-3;
  t.semantic_gradient = t.bfloat16_rows;
  t.coupling = t.bfloat16_coupling;
  return t;
}

template <class A, class B>
void expect_close(const A& a, const B& b, double tolerance, const std::string& what) {
  const Difference d = difference(a, b);
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_LE(d.worst, tolerance) << what << ": entry " << d.at << " is " << a[d.at] << " instead of " << b[d.at]
                                << ", largest " << d.scale;
}

inline constexpr CouplingBalance kBalance{2e-4, 1e-3};  ///< of earlier steps

/// One step of the engine beside the reference. The map losses are evaluated once, on the engine's maps. A pixel on the
/// edge of a loss's validity hence does not count as a difference of the engine.
inline void compare_products(SemanticProducts products, const GaussianModel& model, const TrainingView& view,
                             const StepRequest& request, const Tolerance& tolerance, const CouplingBalance& balance) {
  CpuEngine engine(2);
  engine.keep_features(true);
  engine.set_semantic_products(products);
  engine.load(model);
  engine.set_training_views({view});
  engine.set_coupling_balance(balance);
  const StepReport report = engine.step(request);
  ASSERT_FALSE(report.non_finite.found) << report.non_finite.term;

  const GaussianModelT<double> exact = to_double(model);
  const auto splats = reference::make_splats(exact, view.data.camera, request.raster, request.sh_degree);
  const RenderMaps<double> maps = reference::render_maps(splats, request.raster);
  expect_close(engine.last_maps().color, maps.color, tolerance.map, "colour");
  expect_close(engine.last_maps().alpha, maps.alpha, tolerance.map, "alpha");
  const LossSettings& set = request.losses;
  if (set.weight[Loss::kLogDepth] != 0) {
    expect_close(engine.last_maps().normal, maps.normal, tolerance.map, "normal");
    expect_close(engine.last_maps().distance, maps.distance, tolerance.map, "distance");
    expect_close(engine.last_maps().expected, maps.expected, 10 * tolerance.map, "expected depth");
  }

  const reference::MapLossFunction<double> map_loss = [&](const RenderMaps<double>&, LossTerms& terms,
                                                          MapGradients<double>& out) {
    MapGradients<float> gradients;
    gradients.reset(engine.last_maps().pixels());
    map_losses(MapLossInputs<float>{engine.last_maps(), view, request.losses}, terms, gradients);
    out.color.assign(gradients.color.begin(), gradients.color.end());
    out.normal.assign(gradients.normal.begin(), gradients.normal.end());
    out.distance.assign(gradients.distance.begin(), gradients.distance.end());
    out.alpha.assign(gradients.alpha.begin(), gradients.alpha.end());
  };
  const double scale = coupling_factor(set.coupling_strength, balance);
  const auto want = reference::gradients<double>(exact, view, request, scale, map_loss);

  EXPECT_EQ(report.visible, want.visible);
  EXPECT_NEAR(report.losses.total, want.losses.total,
              tolerance.loss * std::abs(want.losses.total) + 2 * tolerance.semantic_loss);
  EXPECT_NEAR(report.losses[Loss::kSemanticSoft], want.losses[Loss::kSemanticSoft], tolerance.semantic_loss);
  EXPECT_NEAR(report.losses[Loss::kSemanticHard], want.losses[Loss::kSemanticHard], tolerance.semantic_loss);
  EXPECT_NEAR(report.losses[Loss::kFlatten], want.losses[Loss::kFlatten], tolerance.loss);
  EXPECT_NEAR(report.losses[Loss::kOpacityL1], want.losses[Loss::kOpacityL1], tolerance.loss);
  EXPECT_NEAR(report.losses[Loss::kScaleL1], want.losses[Loss::kScaleL1], tolerance.loss);

  const GaussianModel got = engine.last_gradients();
  const double shape = tolerance.gradient + (set.coupling_strength != 0 ? tolerance.coupling : 0.0);
  expect_close(got.positions, want.gradient.positions, shape, "d positions");
  expect_close(got.log_scales, want.gradient.log_scales, shape, "d log_scales");
  expect_close(got.rotations, want.gradient.rotations, shape, "d rotations");
  expect_close(got.opacity_logits, want.gradient.opacity_logits, shape, "d opacity_logits");
  expect_close(got.sh, want.gradient.sh, tolerance.gradient, "d sh");
  expect_close(got.semantics, want.gradient.semantics, tolerance.semantic_gradient, "d semantics");

  const DensityStatistics s = engine.density_statistics();
  expect_close(s.gradient, want.statistics.gradient, tolerance.statistic, "density gradient");
  expect_close(s.gradient_abs, want.statistics.gradient_abs, tolerance.statistic, "density absolute gradient");
  expect_close(s.visible, want.statistics.visible, 0, "density visible");
  expect_close(s.radius, want.statistics.radius, tolerance.statistic, "density radius");
  expect_close(s.weight, want.statistics.weight, tolerance.statistic, "density weight");
  expect_close(s.residual, want.statistics.residual, tolerance.statistic, "density residual");
  expect_close(s.unsupported, want.statistics.unsupported, tolerance.statistic, "density unsupported");

  // One Gaussian alone feels no coupling: what is left is rounding, and whether any is depends on the instruction set.
  const bool coupled = want.coupling_rms > 1e-6 * want.photometric_rms;
  if (is_balanced(set.coupling) && coupled && set.coupling_strength != 0) {
    CouplingBalance next = balance;
    update_coupling_balance(want.photometric_rms, want.coupling_rms, next);
    EXPECT_NEAR(engine.coupling_balance().photometric, next.photometric, 1e-4 * next.photometric);
    EXPECT_NEAR(engine.coupling_balance().semantic, next.semantic, (1e-4 + tolerance.coupling) * next.semantic);
  }
}

/// Compares steps with one way to form the semantic products.
class ParityTest : public ProductsTest {
 protected:
  void compare_step(const GaussianModel& model, const TrainingView& view, const StepRequest& request,
                    const Tolerance& tolerance = {}) const {
    compare_products(GetParam(), model, view, request, exact() ? tolerance : with_bfloat16(tolerance), kBalance);
  }
};

}  // namespace aligngs::cpu::testing_scene
