// Kernels of shape_terms.h.
#include "engine/cuda/shape_terms.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/partial_sums.cuh"
#include "engine/formulas/shape_terms.h"
#include "engine/shared/optimiser_settings.h"

namespace aligngs::cuda {

enum ShapeSum { kFlatten, kOpacity, kScale, kShapeSums };

__device__ __forceinline__ bool usable(float gradient) { return std::abs(gradient) <= kGradientLimit; }

__global__ void __launch_bounds__(kRowThreads)
    shape_terms_kernel(ShapeTermInputs in, ShapeTermOutputs out, DeviceSpan<double> partial) {
  const size_t i = item_index();
  const float rows = static_cast<float>(in.model.gaussians);
  double sums[kShapeSums] = {};
  if (i < in.model.gaussians) {
    const float* log_scales = &in.model.log_scales[3 * i];
    float* d_scale = &out.gradients.log_scales[3 * i];
    const Vec3<float> log_scale{log_scales[0], log_scales[1], log_scales[2]};
    if (in.settings.weight[Loss::kFlatten] != 0 && in.touched[i] != 0) {
      const float value = flatten_value(log_scale, in.extent);
      sums[kFlatten] = value;
      d_scale[smallest_axis(log_scale)] +=
          in.settings.weight[Loss::kFlatten] * value / static_cast<float>(in.visible[0]);
    }
    if (in.settings.weight[Loss::kOpacityL1] != 0) {
      float derivative = 0;
      sums[kOpacity] = opacity_of_logit(in.model.opacity_logits[i], derivative);
      out.gradients.opacity_logits[i] += in.settings.weight[Loss::kOpacityL1] * derivative / rows;
    }
    if (in.settings.weight[Loss::kScaleL1] != 0) {
      for (int k = 0; k < 3; ++k) {
        const float value = scale_value(log_scale[k], in.extent);
        if (value - value != 0) continue;  // a row so large that projection culls it
        sums[kScale] += value;
        d_scale[k] += in.settings.weight[Loss::kScaleL1] * value / (3 * rows);
      }
    }
    if (!usable(d_scale[0]) || !usable(d_scale[1]) || !usable(d_scale[2])) {
      atomicMin(&out.bad[0], bad_gradient_key(i, GradientClass::kLogScales));
    } else if (!usable(out.gradients.opacity_logits[i])) {
      atomicMin(&out.bad[0], bad_gradient_key(i, GradientClass::kOpacityLogits));
    }
  }
  store_partial_sums(sums, partial);
}

__global__ void __launch_bounds__(kSumThreads)
    finish_shape_terms_kernel(ShapeTermInputs in, DeviceSpan<const double> partial, DeviceSpan<LossTerms> terms) {
  double sums[kShapeSums];
  load_partial_sums(partial, sums);
  if (threadIdx.x != 0) return;
  const double rows = static_cast<double>(in.model.gaussians), visible = in.visible[0];
  const double flatten = visible > 0 ? sums[kFlatten] / visible : 0.0;
  const double opacity = rows > 0 ? sums[kOpacity] / rows : 0.0;
  const double scale = rows > 0 ? sums[kScale] / (3 * rows) : 0.0;
  LossTerms& t = terms[0];
  t.add(Loss::kFlatten, in.settings.weight[Loss::kFlatten], flatten);
  t.add(Loss::kOpacityL1, in.settings.weight[Loss::kOpacityL1], opacity);
  t.add(Loss::kScaleL1, in.settings.weight[Loss::kScaleL1], scale);
}

void add_shape_terms(DeviceArena& arena, const ShapeTermInputs& in, const ShapeTermOutputs& out) {
  const LossSettings& s = in.settings;
  if (!s.has(LossStage::kShape)) return;
  const LaunchShape shape = one_per_item(in.model.gaussians, kRowThreads);
  const DeviceSpan<double> partial = arena.take<double>(shape.grid.x * size_t(kShapeSums), "sums of the shape terms");
  launch(arena.context(), "shape_terms", shape_terms_kernel, shape, in, out, partial);
  launch(arena.context(), "finish_shape_terms", finish_shape_terms_kernel, {dim3(1), dim3(kSumThreads), 0}, in, partial,
         out.terms);
}

}  // namespace aligngs::cuda
