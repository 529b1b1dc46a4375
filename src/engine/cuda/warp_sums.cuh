// Operations of warps and blocks that the backward kernels share; blocks are one-dimensional.
#pragma once

#include "device/block_reduce.cuh"

namespace aligngs::cuda {

inline constexpr int kWarp = 32;

/// Steps kWidth, kWidth / 2, ... 1 of warp_sums. Each is an instance of its own: a loop over the widths is not always
/// unrolled, and then v lies in memory instead of registers.
template <int kWidth>
__device__ __forceinline__ void halve_sums(float (&v)[kWarp], int lane) {
  const bool upper = (lane & kWidth) != 0;
#pragma unroll
  for (int k = 0; k < kWidth; ++k) {
    const float give = upper ? v[k] : v[k + kWidth], keep = upper ? v[k + kWidth] : v[k];
    v[k] = keep + __shfl_xor_sync(kFullWarp, give, kWidth);
  }
  if constexpr (kWidth > 1) halve_sums<kWidth / 2>(v, lane);
}

/// The sum over the lanes of v[l], to lane l; v is used up. 31 shuffles for 32 sums: at each step a lane hands on half
/// of what it still holds.
__device__ __forceinline__ float warp_sums(float (&v)[kWarp]) {
  halve_sums<kWarp / 2>(v, static_cast<int>(lane_index()));
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
