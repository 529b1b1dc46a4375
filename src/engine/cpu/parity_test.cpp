// The engine against the scalar reference in double precision: maps, losses, every gradient and statistic.
#include "engine/cpu/simd_targets.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/test_scenes.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

/// Tolerances, relative to the largest entry of a map or of a class of gradients. A mean of a few hundred pixels has an
/// ulp of 3e-5 pixels, which moves the alpha of a splat of one pixel's size by 1e-4 of itself.
struct Tolerance {
  double map = 2e-5;
  double loss = 2e-5;
  double gradient = 2e-4;
  double statistic = 5e-4;
  double semantic_loss = 2e-5;      ///< nats
  double semantic_gradient = 2e-4;  ///< of the semantic rows
  double coupling = 0;              ///< of gradients that the semantic loss reaches, beside `gradient`
  double bfloat16_coupling = 2e-3;  ///< the same with bfloat16 products
};

/// bfloat16 operands have 8 significant bits: 2^-9 relative per term of a product, of which hundreds are summed.
Tolerance with_bfloat16(Tolerance t) {
  t.semantic_loss = 2e-3;
  t.semantic_gradient = 5e-3;
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

/// One step of the engine beside the reference. The map losses are evaluated once, on the engine's maps, so that a
/// pixel on the edge of a loss's validity does not count as a difference of the engine.
void compare_products(SemanticProducts products, const GaussianModel& model, const TrainingView& view,
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
  if (set.log_depth_weight != 0) {
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
  EXPECT_NEAR(report.losses.semantic_soft, want.losses.semantic_soft, tolerance.semantic_loss);
  EXPECT_NEAR(report.losses.semantic_hard, want.losses.semantic_hard, tolerance.semantic_loss);
  EXPECT_NEAR(report.losses.flatten, want.losses.flatten, tolerance.loss);
  EXPECT_NEAR(report.losses.opacity_l1, want.losses.opacity_l1, tolerance.loss);
  EXPECT_NEAR(report.losses.scale_l1, want.losses.scale_l1, tolerance.loss);

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

  if (is_balanced(set.coupling) && want.coupling_rms > 0 && set.coupling_strength != 0) {
    CouplingBalance next = balance;
    update_coupling_balance(want.photometric_rms, want.coupling_rms, next);
    EXPECT_NEAR(engine.coupling_balance().photometric, next.photometric, 1e-4 * next.photometric);
    EXPECT_NEAR(engine.coupling_balance().semantic, next.semantic, (1e-4 + tolerance.coupling) * next.semantic);
  }
}

/// The same for every way to form the semantic products that this machine has.
void compare_step(const GaussianModel& model, const TrainingView& view, const StepRequest& request,
                  const Tolerance& tolerance = {}, const CouplingBalance& balance = {2e-4, 1e-3}) {
  {
    SCOPED_TRACE("float32 products");
    compare_products(SemanticProducts::kFloat32, model, view, request, tolerance, balance);
  }
  if (model.semantic_channels == 0 || !matrix_tiles_available()) return;
  SCOPED_TRACE("bfloat16 products");
  compare_products(SemanticProducts::kBfloat16, model, view, request, with_bfloat16(tolerance), balance);
}

TEST(CpuParity, PhotometricLosses) {
  SceneOptions o;
  o.channels = 0;
  compare_step(make_model(o), make_view(o), make_request());
}

TEST(CpuParity, GeometryLosses) {
  SceneOptions o;
  o.channels = 0;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST(CpuParity, ScaledPriorDepth) {
  SceneOptions o;
  o.channels = 0;
  const GaussianModel model = make_model(o);
  StepRequest r = make_geometry_request();
  const auto unsupported = [&](float scale) {
    r.losses.prior_depth_scale = scale;
    CpuEngine engine(1);
    engine.load(model);
    engine.set_training_views({make_view(o)});
    engine.step(r);
    return engine.density_statistics().unsupported;
  };
  EXPECT_NE(unsupported(1.0f), unsupported(1.2f));  // the scene tells the scaled prior from the raw one
  r.losses.prior_depth_scale = 1.2f;
  compare_step(model, make_view(o), r);
}

TEST(CpuParity, EveryLossWithBoundedCouplingOfProbabilities) {
  const SceneOptions o;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST(CpuParity, PlainCouplingOfProbabilities) {
  const SceneOptions o;
  StepRequest r = make_request();
  r.losses.coupling = SemanticCoupling::kPlain;
  r.losses.coupling_strength = 1;
  Tolerance t;
  t.bfloat16_coupling = 2e-2;  // t / Q reaches hundreds where the student misses the teacher's class
  compare_step(make_model(o), make_view(o), r, t);
}

TEST(CpuParity, PlainCouplingOfLogits) {
  const SceneOptions o;
  StepRequest r = make_request();
  r.losses.semantic_blend = SemanticBlend::kLogits;
  r.losses.coupling = SemanticCoupling::kPlain;
  r.losses.coupling_strength = 1;
  compare_step(make_model(o), make_view(o), r);
}

TEST(CpuParity, BoundedCouplingOfLogits) {
  const SceneOptions o;
  StepRequest r = make_request();
  r.losses.semantic_blend = SemanticBlend::kLogits;
  compare_step(make_model(o), make_view(o), r);
}

TEST(CpuParity, NoCoupling) {
  const SceneOptions o;
  StepRequest r = make_request();
  r.losses.coupling_strength = 0;
  compare_step(make_model(o), make_view(o), r);
}

TEST(CpuParity, OpacityInPlaceOfACoupling) {
  const SceneOptions o;
  StepRequest r = make_request();
  r.losses.coupling = SemanticCoupling::kOpacity;
  compare_step(make_model(o), make_view(o), r);
  r.losses.semantic_blend = SemanticBlend::kLogits;
  compare_step(make_model(o), make_view(o), r);
}

TEST(CpuParity, PartOfThePixels) {
  const SceneOptions o;
  StepRequest r = make_request();
  for (const SemanticSample sample : {SemanticSample{2, 1, 4}, SemanticSample{1, 2, 4}, SemanticSample{1, 3, 5}}) {
    r.losses.semantic_sample = sample;
    r.losses.semantic_blend = SemanticBlend::kProbabilities;
    compare_step(make_model(o), make_view(o), r);
    r.losses.semantic_blend = SemanticBlend::kLogits;
    compare_step(make_model(o), make_view(o), r);
  }
}

TEST(CpuParity, NoPixelInThisVisit) {
  const SceneOptions o;  // one square only, whose turn is another
  StepRequest r = make_request();
  r.losses.semantic_sample = {1, 2};
  compare_step(make_model(o), make_view(o), r);
}

TEST(CpuParity, OneClass) {
  SceneOptions o;
  o.channels = 1;
  compare_step(make_model(o), make_view(o), make_request());
}

TEST(CpuParity, HundredAndFiftyClasses) {
  SceneOptions o;
  o.channels = 150;
  o.gaussians = 120;
  compare_step(make_model(o), make_view(o), make_geometry_request());
  StepRequest r = make_request();
  r.losses.semantic_blend = SemanticBlend::kLogits;
  r.losses.coupling = SemanticCoupling::kPlain;
  r.losses.coupling_strength = 1;
  compare_step(make_model(o), make_view(o), r);
}

TEST(CpuParity, SmoothCutoff) {
  const SceneOptions o;
  StepRequest r = make_geometry_request();
  r.raster.smooth_cutoff = true;
  compare_step(make_model(o), make_view(o), r);
}

TEST(CpuParity, TinyGaussians) {
  SceneOptions o;
  o.log_scale_min = -12;
  o.log_scale_max = -7;  // the low-pass alone gives them their size
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST(CpuParity, HugeGaussians) {
  SceneOptions o;
  o.gaussians = 60;
  o.log_scale_min = 0;
  o.log_scale_max = 4;
  o.logit_max = -1;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST(CpuParity, Needles) {
  SceneOptions o;
  GaussianModel m = make_model(o);
  for (size_t i = 0; i < m.size(); ++i) {
    m.log_scales[3 * i] = 0.5f;  // hundreds of pixels long, one wide
    m.log_scales[3 * i + 1] = -7;
    m.log_scales[3 * i + 2] = -7;
  }
  Tolerance t;
  t.map = 1e-3;  // 1e-4 pixels of rounding across a needle one pixel wide
  t.gradient = 5e-3;
  t.statistic = 5e-3;
  compare_step(m, make_view(o), make_geometry_request(), t);
}

TEST(CpuParity, OpaqueStackBehindWhichNothingShows) {
  SceneOptions o;
  o.gaussians = 400;
  o.log_scale_min = -2;
  o.log_scale_max = -0.5;
  o.logit_min = 3;
  o.logit_max = 9;  // alpha reaches its cap; transmittance falls below 1e-4 within two or three
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST(CpuParity, NearPlaneAndBehindTheCamera) {
  SceneOptions o;
  o.depth_min = -1;
  o.depth_max = 0.6;
  o.log_scale_max = -3;
  Tolerance t;
  t.map = 1e-4;
  t.gradient = 1e-3;
  t.statistic = 2e-3;
  compare_step(make_model(o), make_view(o), make_request(), t);
}

TEST(CpuParity, OnePixel) {
  SceneOptions o;
  o.width = o.height = 1;
  o.gaussians = 40;
  compare_step(make_model(o), make_view(o), make_request());
}

TEST(CpuParity, OneRowOfPixels) {
  SceneOptions o;
  o.width = 41;
  o.height = 1;
  compare_step(make_model(o), make_view(o), make_request());
}

TEST(CpuParity, ExactlyOneTile) {
  SceneOptions o;
  o.width = o.height = 16;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST(CpuParity, EveryInstructionSet) {
  SceneOptions o;
  o.channels = 37;
  o.gaussians = 150;
  const GaussianModel model = make_model(o);
  const TrainingView view = make_view(o);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    compare_step(model, view, make_geometry_request());
    StepRequest r = make_request();
    r.losses.semantic_blend = SemanticBlend::kLogits;
    compare_step(model, view, r);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace aligngs::cpu
