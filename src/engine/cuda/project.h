// Gaussians to splats: projection, colour and tile rectangles, formulas/projection.h and color.h per row.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "engine/cuda/view_spans.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct ProjectInputs {
  ModelSpans model;
  RasterSettings raster;
  int sh_degree = 0;
};

/// Writes every rectangle, and splat and radius of the rows with one. `bad` [1] is lowered to the key
/// (parameter_gradients.h) of the first row with a parameter that is not finite. Finite rows whose image overflows are
/// only culled.
void project_view(const DeviceContext& context, const ProjectInputs& in, const ViewSpans& view,
                  DeviceSpan<unsigned long long> bad);

}  // namespace aligngs::cuda
