// Statistics for density control on the device; what they are: gaussians/density_control.h.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/view_spans.h"
#include "gaussians/density_control.h"

namespace aligngs::cuda {

/// [N] each, the fields of DensityStatistics.
struct DensitySpans {
  DeviceSpan<float> gradient, gradient_abs, visible, radius, weight, residual, unsupported;
};

struct DensityInputs {
  ViewSpans view;
  DeviceSpan<const uint8_t> touched;   ///< [N]
  DeviceSpan<const DensitySums> sums;  ///< [N], touched rows
  DeviceSpan<const uint32_t> blocked;  ///< [1] not 0: nothing is written; empty: never blocked
};

/// Adds this view's share.
void add_density_statistics(const DeviceContext& context, const DensityInputs& in, const DensitySpans& statistics);

}  // namespace aligngs::cuda
