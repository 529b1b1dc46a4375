// Sums of the columns of a small table on the device, in a fixed order.
#pragma once

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/warp_sums.cuh"

namespace aligngs::cuda {

/// One block: out[k] = factor * sum over j of in[kWidth j + k].
template <int kWidth>
__global__ void sum_columns_kernel(DeviceSpan<const double> in, double factor, DeviceSpan<double> out) {
  __shared__ double scratch[kWarp];
  const size_t rows = in.size / kWidth;
  for (int k = 0; k < kWidth; ++k) {
    double sum = 0;
    for (size_t j = threadIdx.x; j < rows; j += blockDim.x) sum += in[j * kWidth + static_cast<size_t>(k)];
    sum = block_sum(sum, scratch);
    if (threadIdx.x == 0) out[static_cast<size_t>(k)] = sum * factor;
  }
}

template <int kWidth>
void sum_columns(const DeviceContext& context, DeviceSpan<const double> in, double factor, DeviceSpan<double> out) {
  launch(context, "sum_columns", sum_columns_kernel<kWidth>, {dim3(1), dim3(kSumThreads), 0}, in, factor, out);
}

}  // namespace aligngs::cuda
