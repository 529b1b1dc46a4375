// Kernels of restructure.h.
#pragma once

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "engine/cuda/restructure.h"

namespace aligngs::cuda {

/// out[row] = in[source[row]], or zero where only kept rows count. One thread per number.
__global__ void __launch_bounds__(kRowThreads) gather_rows(DevicePlan::Spans plan, size_t width, bool kept_only,
                                                           DeviceSpan<const float> in, DeviceSpan<float> out) {
  const size_t i = item_index();
  if (i >= out.size) return;
  const size_t row = i / width, column = i % width;
  out[i] = kept_only && plan.kept[row] == 0 ? 0.0f : in[plan.source[row] * width + column];
}

__global__ void __launch_bounds__(kRowThreads) move_new_rows(DevicePlan::Spans plan, ModelSpans model) {
  const size_t i = item_index();
  if (i >= model.gaussians || plan.kept[i] != 0) return;
  for (size_t k = 0; k < 3; ++k) {
    model.positions[3 * i + k] += plan.offset[3 * i + k];
    model.log_scales[3 * i + k] -= plan.log_shrink[i];
  }
  const float logit = plan.opacity_logit[i];
  if (logit == logit) model.opacity_logits[i] = logit;
}

}  // namespace aligngs::cuda
