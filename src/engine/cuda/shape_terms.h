// The losses of the Gaussians themselves (formulas/shape_terms.h): flattening, opacity and scale.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "engine/loss_terms.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct ShapeTermInputs {
  ModelSpans model;
  DeviceSpan<const uint8_t> touched;   ///< [N] of mark_touched
  DeviceSpan<const uint32_t> visible;  ///< [1] of mark_touched
  LossSettings settings;
  float extent = 1;  ///< StepRequest::extent
};

struct ShapeTermOutputs {
  ModelSpans gradients;                ///< log_scales and opacity_logits are added to
  DeviceSpan<LossTerms> terms;         ///< [1] flatten, opacity_l1, scale_l1 and total are added to
  DeviceSpan<unsigned long long> bad;  ///< [1] lowered as by parameter_gradients
};

/// Does nothing where all three weights are 0. Scratch comes from the arena.
void add_shape_terms(DeviceArena& arena, const ShapeTermInputs& in, const ShapeTermOutputs& out);

}  // namespace aligngs::cuda
