// The engine against the scalar reference in double precision, loss by loss and scene by scene.
#include "engine/cpu/testing/parity.h"
#include "engine/cpu/testing/each_instruction_set.h"

#include <hwy/targets.h>

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

class CpuParity : public ParityTest {};
INSTANTIATE_TEST_SUITE_P(Products, CpuParity, every_products(), products_name);

/// Without semantics there is one way.
void compare_step_without_semantics(const GaussianModel& model, const TrainingView& view, const StepRequest& request,
                                    const Tolerance& tolerance = {}) {
  ASSERT_EQ(model.semantic_channels, 0);
  compare_products(SemanticProducts::kFloat32, model, view, request, tolerance, kBalance);
}

TEST(CpuParityWithoutSemantics, PhotometricLosses) {
  RandomSceneOptions o;
  o.channels = 0;
  compare_step_without_semantics(make_model(o), make_view(o), make_request());
}

TEST(CpuParityWithoutSemantics, GeometryLosses) {
  RandomSceneOptions o;
  o.channels = 0;
  compare_step_without_semantics(make_model(o), make_view(o), make_geometry_request());
}

TEST(CpuParityWithoutSemantics, OpacityDropout) {
  RandomSceneOptions o;
  o.channels = 0;
  StepRequest r = make_geometry_request();
  r.raster.dropout = {0.3f, 11};
  compare_step_without_semantics(make_model(o), make_view(o), r);
}

TEST(CpuParityWithoutSemantics, ScaledPriorDepth) {
  RandomSceneOptions o;
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
  compare_step_without_semantics(model, make_view(o), r);
}

TEST_P(CpuParity, EveryLossWithBoundedCouplingOfProbabilities) {
  const RandomSceneOptions o;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST_P(CpuParity, PlainCouplingOfProbabilities) {
  const RandomSceneOptions o;
  StepRequest r = make_request();
  r.losses.coupling = SemanticCoupling::kPlain;
  r.losses.coupling_strength = 1;
  Tolerance t;
  t.bfloat16_coupling = 2e-2;  // t / Q reaches hundreds where the student misses the teacher's class
  compare_step(make_model(o), make_view(o), r, t);
}

TEST_P(CpuParity, PlainCouplingOfLogits) {
  const RandomSceneOptions o;
  StepRequest r = make_request();
  r.losses.semantic_blend = SemanticBlend::kLogits;
  r.losses.coupling = SemanticCoupling::kPlain;
  r.losses.coupling_strength = 1;
  compare_step(make_model(o), make_view(o), r);
}

TEST_P(CpuParity, BoundedCouplingOfLogits) {
  const RandomSceneOptions o;
  StepRequest r = make_request();
  r.losses.semantic_blend = SemanticBlend::kLogits;
  compare_step(make_model(o), make_view(o), r);
}

TEST_P(CpuParity, NoCoupling) {
  const RandomSceneOptions o;
  StepRequest r = make_request();
  r.losses.coupling_strength = 0;
  compare_step(make_model(o), make_view(o), r);
}

TEST_P(CpuParity, OpacityInPlaceOfACoupling) {
  const RandomSceneOptions o;
  StepRequest r = make_request();
  r.losses.coupling = SemanticCoupling::kOpacity;
  compare_step(make_model(o), make_view(o), r);
  r.losses.semantic_blend = SemanticBlend::kLogits;
  compare_step(make_model(o), make_view(o), r);
}

TEST_P(CpuParity, PartOfThePixels) {
  const RandomSceneOptions o;
  StepRequest r = make_request();
  for (const SemanticSample sample : {SemanticSample{2, 1, 4}, SemanticSample{1, 2, 4}, SemanticSample{1, 3, 5}}) {
    r.losses.semantic_sample = sample;
    r.losses.semantic_blend = SemanticBlend::kProbabilities;
    compare_step(make_model(o), make_view(o), r);
    r.losses.semantic_blend = SemanticBlend::kLogits;
    compare_step(make_model(o), make_view(o), r);
  }
}

TEST_P(CpuParity, NoPixelInThisVisit) {
  const RandomSceneOptions o;  // one square only, whose turn is another
  StepRequest r = make_request();
  r.losses.semantic_sample = {1, 2};
  compare_step(make_model(o), make_view(o), r);
}

TEST_P(CpuParity, OneClass) {
  RandomSceneOptions o;
  o.channels = 1;
  compare_step(make_model(o), make_view(o), make_request());
}

TEST_P(CpuParity, HundredAndFiftyClassesAndOneMore) {
  for (const int channels : {150, 151}) {
    SCOPED_TRACE(channels);
    RandomSceneOptions o;
    o.channels = channels;
    o.gaussians = 120;
    {
      SCOPED_TRACE("default");
      compare_step(make_model(o), make_view(o), make_geometry_request());
    }
    SCOPED_TRACE("paper");
    StepRequest r = make_request();
    r.losses.semantic_blend = SemanticBlend::kLogits;
    r.losses.coupling = SemanticCoupling::kPlain;
    r.losses.coupling_strength = 1;
    compare_step(make_model(o), make_view(o), r, of_coupling_alone());
  }
}

TEST_P(CpuParity, SmoothCutoff) {
  const RandomSceneOptions o;
  StepRequest r = make_geometry_request();
  r.raster.smooth_cutoff = true;
  compare_step(make_model(o), make_view(o), r);
}

TEST_P(CpuParity, TinyGaussians) {
  RandomSceneOptions o;
  o.log_scale_min = -12;
  o.log_scale_max = -7;  // the low-pass alone gives them their size
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST_P(CpuParity, HugeGaussians) {
  RandomSceneOptions o;
  o.gaussians = 60;
  o.log_scale_min = 0;
  o.log_scale_max = 4;
  o.logit_max = -1;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST_P(CpuParity, Needles) {
  RandomSceneOptions o;
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

TEST_P(CpuParity, OpaqueStackBehindWhichNothingShows) {
  RandomSceneOptions o;
  o.gaussians = 400;
  o.log_scale_min = -2;
  o.log_scale_max = -0.5;
  o.logit_min = 3;
  o.logit_max = 9;  // alpha reaches its cap; transmittance falls below 1e-4 within two or three
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST_P(CpuParity, NearPlaneAndBehindTheCamera) {
  RandomSceneOptions o;
  o.depth_min = -1;
  o.depth_max = 0.6;
  o.log_scale_max = -3;
  Tolerance t;
  t.map = 1e-4;
  t.gradient = 1e-3;
  t.statistic = 2e-3;
  compare_step(make_model(o), make_view(o), make_request(), t);
}

TEST_P(CpuParity, OnePixel) {
  RandomSceneOptions o;
  o.width = o.height = 1;
  o.gaussians = 40;
  compare_step(make_model(o), make_view(o), make_request());
}

TEST_P(CpuParity, OneRowOfPixels) {
  RandomSceneOptions o;
  o.width = 41;
  o.height = 1;
  compare_step(make_model(o), make_view(o), make_request());
}

TEST_P(CpuParity, ExactlyOneTile) {
  RandomSceneOptions o;
  o.width = o.height = 16;
  compare_step(make_model(o), make_view(o), make_geometry_request());
}

TEST_P(CpuParity, EveryInstructionSet) {
  RandomSceneOptions o;
  o.channels = 37;
  o.gaussians = 150;
  const GaussianModel model = make_model(o);
  const TrainingView view = make_view(o);
  for_each_target([&] {
    compare_step(model, view, make_geometry_request());
    StepRequest r = make_request();
    r.losses.semantic_blend = SemanticBlend::kLogits;
    compare_step(model, view, r);
  });
}

}  // namespace
}  // namespace aligngs::cpu
