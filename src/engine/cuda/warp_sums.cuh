// Operations of warps and blocks that the backward kernels share; blocks are one-dimensional.
#pragma once

#include "engine/cuda/runtime/block_reduce.cuh"

namespace aligngs::cuda {

inline constexpr int kWarp = 32;

/// The sum over the lanes of v[l], to lane l; v is used up. 31 shuffles for 32 sums: at each step a lane hands on half
/// of what it still holds.
__device__ __forceinline__ float warp_sums(float (&v)[kWarp]) {
  const int lane = static_cast<int>(lane_index());
#pragma unroll
  for (int width = kWarp / 2; width >= 1; width /= 2) {
    const bool upper = (lane & width) != 0;
#pragma unroll
    for (int k = 0; k < width; ++k) {
      const float give = upper ? v[k] : v[k + width], keep = upper ? v[k + width] : v[k];
      v[k] = keep + __shfl_xor_sync(kFullWarp, give, width);
    }
  }
  return v[0];
}

/// Appends `value` of the threads with `keep` to list[length ...) in the order of the threads and returns the new
/// length to all of them. All threads of the block call it; `counts` holds a number per warp. Ends with a barrier.
template <class T>
__device__ __forceinline__ int append(bool keep, T value, T* list, int length, int* counts) {
  const int lane = static_cast<int>(lane_index()), warp = static_cast<int>(warp_index());
  const int warps = static_cast<int>(block_threads()) / kWarp;
  const unsigned votes = __ballot_sync(kFullWarp, keep);
  if (lane == 0) counts[warp] = __popc(votes);
  __syncthreads();
  int before = length, total = length;
  for (int k = 0; k < warps; ++k) {
    before += k < warp ? counts[k] : 0;
    total += counts[k];
  }
  if (keep) list[before + __popc(votes & ((1u << lane) - 1u))] = value;
  __syncthreads();
  return total;
}

}  // namespace aligngs::cuda
