// The model's arrays on the device; of the same shape are its moments and gradients.
#pragma once

#include <cstddef>
#include <cstdint>

#include "device/device_span.h"

namespace aligngs::cuda {

/// Arrays as in GaussianModel, gaussians/gaussian_model.h.
struct ModelSpans {
  size_t gaussians = 0;              ///< N
  int channels = 0;                  ///< C, the remainder of the active classes included
  DeviceSpan<float> positions;       ///< [N][3]
  DeviceSpan<float> log_scales;      ///< [N][3]
  DeviceSpan<float> rotations;       ///< [N][4], w x y z
  DeviceSpan<float> opacity_logits;  ///< [N]
  DeviceSpan<float> sh;              ///< [N][16][3]
  DeviceSpan<float> semantics;       ///< [N][C]
};

}  // namespace aligngs::cuda
