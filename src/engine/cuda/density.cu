#include "engine/cuda/density.h"

#include "engine/cuda/constants.h"
#include "engine/cuda/density.cuh"
#include "engine/cuda/runtime/launch.h"

namespace aligngs::cuda {

void add_density_statistics(const DeviceContext& context, const DensityInputs& in, const DensitySpans& statistics) {
  launch(context, "density", density_kernel, one_per_item(in.touched.size, kRowThreads), in, statistics);
}

}  // namespace aligngs::cuda
