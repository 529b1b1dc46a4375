// Sums over a warp or a block in a fixed order, so that results are the same on every run.
#pragma once

#include "device/device_language.h"

namespace aligngs::cuda {

constexpr unsigned kFullWarp = 0xffffffffu;

/// Index of the thread in its block, whatever the block's shape.
__device__ __forceinline__ unsigned thread_rank() {
  return threadIdx.x + blockDim.x * (threadIdx.y + blockDim.y * threadIdx.z);
}
__device__ __forceinline__ unsigned block_threads() { return blockDim.x * blockDim.y * blockDim.z; }
__device__ __forceinline__ unsigned lane_index() { return thread_rank() & 31u; }
__device__ __forceinline__ unsigned warp_index() { return thread_rank() >> 5; }
/// Index of the thread in a one-dimensional grid.
__device__ __forceinline__ size_t item_index() { return size_t(blockIdx.x) * blockDim.x + threadIdx.x; }

/// The sum over all 32 lanes, the same bits in each. T: float, double, int, unsigned.
template <class T>
__device__ __forceinline__ T warp_sum(T value) {
  for (int step = 16; step > 0; step >>= 1) value += __shfl_xor_sync(kFullWarp, value, step);
  return value;
}

template <class T>
__device__ __forceinline__ T warp_maximum(T value) {
  for (int step = 16; step > 0; step >>= 1) {
    const T other = __shfl_xor_sync(kFullWarp, value, step);
    value = other > value ? other : value;
  }
  return value;
}

/// The sum over the block, returned to every thread. All threads must call it. `scratch`: 32 elements of shared
/// memory, free for other use again when the call returns.
template <class T>
__device__ T block_sum(T value, T* scratch) {
  value = warp_sum(value);
  if (lane_index() == 0) scratch[warp_index()] = value;
  __syncthreads();
  const unsigned warps = block_threads() / 32;
  T sum = scratch[0];
  for (unsigned w = 1; w < warps; ++w) sum += scratch[w];
  __syncthreads();
  return sum;
}

}  // namespace aligngs::cuda
