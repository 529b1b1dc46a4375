#include "engine/cuda/project.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/project.cuh"

namespace aligngs::cuda {

void project_view(const DeviceContext& context, const ProjectInputs& in, const ViewSpans& view,
                  DeviceSpan<unsigned long long> bad) {
  launch(context, "project_rows", project_rows, one_per_item(in.model.gaussians, kRowThreads), in, view, bad);
}

}  // namespace aligngs::cuda
