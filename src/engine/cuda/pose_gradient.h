// The camera's share of a step's gradients (formulas/pose_gradient.h), summed over the rows.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "engine/formulas/pose_rows.h"

namespace aligngs::cuda {

struct PoseGradientInputs {
  ModelSpans model;
  ModelSpans gradients;               ///< of parameter_gradients
  DeviceSpan<const uint8_t> touched;  ///< [N] of mark_touched: others have no share
  PoseFrame<float> camera;
  int sh_degree = 0;
};

/// out[0] of [1]. Scratch comes from the arena.
void pose_gradient(DeviceArena& arena, const PoseGradientInputs& in, DeviceSpan<PoseGradient<double>> out);

}  // namespace aligngs::cuda
