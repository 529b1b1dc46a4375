// Sums over a grid in a fixed order: each block leaves its own, one block adds them up.
#pragma once

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/device_span.h"

namespace aligngs::cuda {

/// Index and number of the blocks of a grid of any shape.
__device__ __forceinline__ size_t block_number() {
  return blockIdx.x + size_t(gridDim.x) * (blockIdx.y + size_t(gridDim.y) * blockIdx.z);
}
__device__ __forceinline__ size_t block_count() { return size_t(gridDim.x) * gridDim.y * gridDim.z; }

/// partial[kCount][blocks] gets the sums over the block of each thread's `values`: within a warp in T, beyond in
/// double. All threads must call it, once in a kernel. Float suits terms of like size, and GeForce has few units for
/// double.
template <class T, int kCount>
__device__ void store_partial_sums(const T (&values)[kCount], DeviceSpan<double> partial) {
  __shared__ double sums_of_warps[kCount][32];
#pragma unroll
  for (int k = 0; k < kCount; ++k) {
    const T sum = warp_sum(values[k]);
    if (lane_index() == 0) sums_of_warps[k][warp_index()] = static_cast<double>(sum);
  }
  __syncthreads();
  const unsigned k = thread_rank();
  if (k >= kCount) return;
  double sum = 0;
  for (unsigned w = 0; w < block_threads() / 32; ++w) sum += sums_of_warps[k][w];
  partial[size_t(k) * block_count() + block_number()] = sum;
}

/// The sums of all blocks, to every thread of the one block that calls it.
template <int kCount>
__device__ void load_partial_sums(DeviceSpan<const double> partial, double (&sums)[kCount]) {
  __shared__ double scratch[32];
  const size_t blocks = partial.size / kCount;
  for (int k = 0; k < kCount; ++k) {
    double sum = 0;
    for (size_t j = threadIdx.x; j < blocks; j += blockDim.x) sum += partial[size_t(k) * blocks + j];
    sums[k] = block_sum(sum, scratch);
  }
}

}  // namespace aligngs::cuda
