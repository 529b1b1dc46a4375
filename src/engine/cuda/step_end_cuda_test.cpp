// The end of a step before and beside the optimiser. Tests shape terms and density statistics against the CPU engine's,
// the outcome of a step, and the forecast of its memory.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "core/random.h"
#include "device/tolerances.h"
#include "engine/cuda/density.h"
#include "engine/cuda/memory_forecast.h"
#include "engine/cuda/shape_terms.h"
#include "engine/cuda/step_outcome.h"
#include "engine/cuda/testing/view.h"
#include "engine/testing/request.h"

namespace aligngs::cuda {
namespace {

using cpu::testing_scene::difference;
using cpu::testing_scene::make_camera;
using cpu::testing_scene::make_model;
using cpu::testing_scene::make_request;
using cpu::testing_scene::RandomSceneOptions;

const CudaTolerance kStepEndTolerance;

class CudaStepEnd : public DeviceTest {
 protected:
  void prepare() { prepare(make_model(RandomSceneOptions())); }

  void prepare(const GaussianModel& gaussians) {
    model = gaussians;
    request = make_request();
    const RandomSceneOptions scene;
    view = std::make_unique<TestView>(context(), model, make_camera(scene.width, scene.height), request.raster);
    touched.assign(context(), view->cpu_gradients.touched, "test");
    visible.assign(context(), {static_cast<uint32_t>(view->visible)}, "test");
    slots.resize(view->lists.instances());
    if (slots.size() > 0) std::memset(static_cast<void*>(slots.data()), 0, slots.size() * sizeof(slots[0]));
  }

  cpu::ParameterGradientInputs cpu_inputs() const {
    return {model, view->view, view->lists, view->record, slots, request, view->visible, 0.0f};
  }

  /// Slots are zero on the CPU, so its gradients are those of the shape terms.
  void compare_shape_terms() {
    LossTerms want;
    cpu::ParameterGradientTotals totals;
    cpu::parameter_gradients(cpu_inputs(), view->pool, want, totals, view->cpu_gradients);

    GaussianModel zero = model;
    for (auto* v : {&zero.positions, &zero.log_scales, &zero.rotations, &zero.opacity_logits, &zero.sh}) {
      std::fill(v->begin(), v->end(), 0.0f);
    }
    DeviceModel device(context(), model), gradients(context(), zero);
    DeviceArray<LossTerms> terms;
    terms.assign(context(), {LossTerms()}, "test");
    bad.assign(context(), {kNoBadGradient}, "test");
    DeviceArena arena(context());
    add_shape_terms(arena, {device.spans(), touched.span(), visible.span(), request.losses, request.extent},
                    {gradients.spans(), terms.span(), bad.span()});
    const LossTerms got = terms.to_host()[0];
    EXPECT_NEAR(got[Loss::kFlatten], want[Loss::kFlatten], kStepEndTolerance.relative_loss * want[Loss::kFlatten]);
    EXPECT_NEAR(got[Loss::kOpacityL1], want[Loss::kOpacityL1],
                kStepEndTolerance.relative_loss * want[Loss::kOpacityL1]);
    EXPECT_NEAR(got[Loss::kScaleL1], want[Loss::kScaleL1], kStepEndTolerance.relative_loss * want[Loss::kScaleL1]);
    EXPECT_NEAR(got.total, want.total, kStepEndTolerance.relative_loss * want.total);
    const auto to_vector = [](const auto& a) { return std::vector<float>(a.data(), a.data() + a.size()); };
    EXPECT_LT(difference(gradients.log_scales.to_host(), to_vector(view->cpu_gradients.log_scales)).worst,
              kStepEndTolerance.gradient);
    EXPECT_LT(difference(gradients.opacity_logits.to_host(), to_vector(view->cpu_gradients.opacity_logits)).worst,
              kStepEndTolerance.gradient);
  }

  GaussianModel model;
  StepRequest request = color_and_class_request();
  std::unique_ptr<TestView> view;
  cpu::SlotGradients slots;
  DeviceArray<uint8_t> touched;
  DeviceArray<uint32_t> visible;
  DeviceArray<unsigned long long> bad;
};

TEST_F(CudaStepEnd, ShapeTermsAgreeWithTheCpu) {
  prepare();
  ASSERT_GT(view->visible, 0u);
  ASSERT_LT(view->visible, model.size());
  compare_shape_terms();
  EXPECT_EQ(bad.to_host()[0], kNoBadGradient);
}

TEST_F(CudaStepEnd, EachShapeTermAlone) {
  prepare();
  for (const Loss loss : losses_of(LossStage::kShape)) {
    for (const Loss other : losses_of(LossStage::kShape)) request.losses.weight[other] = loss == other ? 3 : 0;
    compare_shape_terms();
  }
}

TEST_F(CudaStepEnd, ScalesBeyondFloatAreLeftOut) {
  GaussianModel huge = make_model(RandomSceneOptions());
  huge.log_scales[3 * 5 + 1] = 200;  // exp overflows; projection culls the row
  prepare(huge);
  compare_shape_terms();
  EXPECT_EQ(bad.to_host()[0], kNoBadGradient);
}

TEST_F(CudaStepEnd, AShapeGradientBeyondTheLimitIsReported) {
  GaussianModel large = make_model(RandomSceneOptions());
  large.log_scales[3 * 7 + 2] = 80;  // exp = 5e34 is finite
  large.log_scales[3 * 9] = 80;
  prepare(large);
  request.losses.weight[Loss::kScaleL1] = 1;
  DeviceModel device(context(), model), gradients(context(), model);
  DeviceArray<LossTerms> terms;
  terms.assign(context(), {LossTerms()}, "test");
  bad.assign(context(), {kNoBadGradient}, "test");
  DeviceArena arena(context());
  add_shape_terms(arena, {device.spans(), touched.span(), visible.span(), request.losses, request.extent},
                  {gradients.spans(), terms.span(), bad.span()});
  EXPECT_EQ(bad.to_host()[0], bad_gradient_key(7, GradientClass::kLogScales));
}

TEST_F(CudaStepEnd, DensityStatisticsAgreeWithTheCpu) {
  prepare();
  const size_t n = model.size();
  Random random(6);
  std::vector<DensitySums> sums(n);
  view->cpu_gradients.density.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const auto number = [&] { return static_cast<float>(random.uniform(0, 0.1)); };
    DensitySums& s = view->cpu_gradients.density[i];
    s = {number() - 0.05f, number() - 0.05f, number(), number(), number(), number(), number()};
    sums[i] = s;
  }
  DensityStatistics want;
  std::vector<DeviceArray<float>> arrays(7);
  for (auto* v : {&want.gradient, &want.gradient_abs, &want.visible, &want.radius, &want.weight, &want.residual,
                  &want.unsupported}) {
    v->assign(n, 0.5f);
  }
  for (DeviceArray<float>& a : arrays) a.assign(context(), std::vector<float>(n, 0.5f), "test");
  DeviceArray<DensitySums> device_sums;
  device_sums.assign(context(), sums, "test");
  DeviceArray<uint32_t> blocked;
  blocked.assign(context(), {0}, "test");
  const DensitySpans spans{arrays[0].span(), arrays[1].span(), arrays[2].span(), arrays[3].span(),
                           arrays[4].span(), arrays[5].span(), arrays[6].span()};
  const DensityInputs in{view->view_spans(), touched.span(), device_sums.span(), blocked.span()};
  for (int repeat = 0; repeat < 2; ++repeat) {
    cpu::add_density_statistics(cpu_inputs(), view->cpu_gradients, view->pool, want);
    add_density_statistics(context(), in, spans);
  }
  const std::vector<float>* wanted[] = {&want.gradient, &want.gradient_abs, &want.visible,    &want.radius,
                                        &want.weight,   &want.residual,     &want.unsupported};
  for (size_t k = 0; k < 7; ++k) {
    EXPECT_LT(difference(arrays[k].to_host(), *wanted[k]).worst, kStepEndTolerance.statistic) << k;
  }
  const std::vector<float> before = arrays[0].to_host();
  blocked.assign(context(), {1}, "test");
  add_density_statistics(context(), in, spans);
  EXPECT_EQ(arrays[0].to_host(), before) << "a blocked step counts for nothing";
}

class CudaStepOutcome : public DeviceTest {
 protected:
  StepOutcome judge(const LossTerms& losses, unsigned long long bad_key = kNoBadGradient) {
    DeviceArray<LossTerms> terms;
    DeviceArray<double> semantic, squares;
    DeviceArray<unsigned long long> bad;
    DeviceArray<uint32_t> visible;
    terms.assign(context(), {losses}, "test");
    semantic.assign(context(), semantic_terms, "test");
    squares.assign(context(), {8.0, 2.0}, "test");
    bad.assign(context(), {bad_key}, "test");
    visible.assign(context(), {2}, "test");
    DeviceArray<StepOutcome> out(context(), 1, "test");
    judge_step(context(), {terms.span(), semantic.span(), squares.span(), bad.span(), visible.span(), 0.5f, 2.0f},
               out.span());
    uint32_t blocked = 7;
    download(context(), &blocked, blocked_of(out.span()));
    EXPECT_EQ(blocked, out.to_host()[0].blocked);
    return out.to_host()[0];
  }
  static LossTerms some_losses() {
    LossTerms t;
    t.total = 1;
    t[Loss::kL1] = 0.25;
    t[Loss::kCrease] = 0.125;
    return t;
  }
  std::vector<double> semantic_terms = {3.0, 4.0};
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
};

TEST_F(CudaStepOutcome, GathersTheParts) {
  const StepOutcome o = judge(some_losses());
  EXPECT_EQ(o.blocked, 0u);
  EXPECT_FALSE(symptom_of(o).found);
  EXPECT_DOUBLE_EQ(o.terms.total, 1 + 0.5 * 3 + 2 * 4);
  EXPECT_DOUBLE_EQ(o.terms[Loss::kSemanticSoft], 3);
  EXPECT_DOUBLE_EQ(o.terms[Loss::kL1], 0.25);
  EXPECT_DOUBLE_EQ(gradient_scale(o).photometric_rms, 2);
  EXPECT_DOUBLE_EQ(gradient_scale(o).coupling_rms, 1);
}

TEST_F(CudaStepOutcome, WithoutSemantics) {
  semantic_terms.clear();
  EXPECT_DOUBLE_EQ(judge(some_losses()).terms.total, 1);
}

TEST_F(CudaStepOutcome, ALossThatIsNotANumberBlocks) {
  LossTerms t = some_losses();
  t[Loss::kCrease] = kNan;
  const StepOutcome o = judge(t);
  EXPECT_EQ(o.blocked, 1u);
  EXPECT_EQ(symptom_of(o).term, "crease");
  EXPECT_EQ(symptom_of(o).gaussian, -1);
}

TEST_F(CudaStepOutcome, ASemanticLossThatIsNotANumberBlocks) {
  semantic_terms[1] = kNan;
  const StepOutcome o = judge(some_losses());
  EXPECT_EQ(o.blocked, 1u);
  EXPECT_EQ(symptom_of(o).term, "semantic_hard");
}

TEST_F(CudaStepOutcome, ABadGradientBlocksAndIsNamed) {
  const StepOutcome o = judge(some_losses(), bad_gradient_key(12, GradientClass::kRotations));
  EXPECT_EQ(o.blocked, 1u);
  EXPECT_EQ(symptom_of(o).term, "rotations");
  EXPECT_EQ(symptom_of(o).gaussian, 12);
}

TEST(CudaForecast, GrowsWithEverythingThatItDependsOn) {
  const MemoryForecastInputs base{1000, 7, 320 * 240};
  MemoryForecastInputs more = base;
  more.gaussians = 2000;
  EXPECT_GT(forecast_bytes(more) - forecast_bytes(base), 1000u * (59 + 7) * 3 * sizeof(float));
  more = base;
  more.channels = 150;
  EXPECT_GT(forecast_bytes(more) - forecast_bytes(base), 1000u * 143 * 3 * sizeof(float));
  more = base;
  more.pixels_per_view *= 4;
  EXPECT_GT(forecast_bytes(more), forecast_bytes(base));
  more = base;
  more.checkpoints = true;
  EXPECT_GT(forecast_bytes(more), forecast_bytes(base));
}

}  // namespace
}  // namespace aligngs::cuda
