#include "engine/cuda/density.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/density.cuh"

namespace aligngs::cuda {

void add_density_statistics(const DeviceContext& context, const DensityInputs& in, const DensitySpans& statistics) {
  launch(context, "density", density_kernel, one_per_item(in.touched.size, kRowThreads), in, statistics);
}

}  // namespace aligngs::cuda
