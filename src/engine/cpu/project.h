// From the model to the splats of one view.
#pragma once

#include "core/thread_pool.h"
#include "engine/cpu/splats.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::cpu {

/// Projects, culls and colours every Gaussian; engine/formulas/projection.h and color.h.
void project_view(const GaussianModel& model, const Camera& camera, const RasterSettings& raster, int sh_degree,
                  ThreadPool& pool, ProjectedView& view);

}  // namespace aligngs::cpu
