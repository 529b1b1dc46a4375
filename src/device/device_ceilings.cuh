// Kernels of device_ceilings.h.
#pragma once

#include <cmath>

#include "device/block_reduce.cuh"
#include "device/device_span.h"
#include "device/tile_mma.cuh"

namespace aligngs::cuda {

inline constexpr unsigned kCeilingThreads = 256;
inline constexpr int kFmaChains = 8;  ///< hide a latency of four cycles on two schedulers' worth of warps
inline constexpr int kMmaChains = 4;  ///< sums of 8 registers each, so that a block's threads fit eightfold
inline constexpr double kFmaOperations = 2.0 * kFmaChains;                                   ///< per thread and round
inline constexpr double kMmaOperations = 2.0 * kMmaTile * kMmaTile * kMmaTile * kMmaChains;  ///< per warp and round

__global__ void __launch_bounds__(kCeilingThreads)
    copy_ceiling_kernel(DeviceSpan<const float4> from, DeviceSpan<float4> to) {
  const size_t step = size_t(gridDim.x) * kCeilingThreads;
  for (size_t i = item_index(); i < from.size; i += step) to[i] = from[i];
}

/// x = a x + b, again and again; the results are kept, so that no compiler may leave it out.
__global__ void __launch_bounds__(kCeilingThreads)
    fma_ceiling_kernel(int rounds, float a, float b, DeviceSpan<float> out) {
  float x[kFmaChains];
#pragma unroll
  for (int k = 0; k < kFmaChains; ++k) x[k] = static_cast<float>(k);
  for (int i = 0; i < rounds; ++i) {
#pragma unroll
    for (int k = 0; k < kFmaChains; ++k) x[k] = std::fma(a, x[k], b);
  }
  float sum = 0;
#pragma unroll
  for (int k = 0; k < kFmaChains; ++k) sum += x[k];
  out[item_index()] = sum;
}

/// A warp adds products of two small operands to its sums.
__global__ void __launch_bounds__(kCeilingThreads)
    mma_ceiling_kernel(int rounds, float a, float b, DeviceSpan<float> out) {
  TileOperand left, right;
  for (int k = 0; k < 4; ++k) {
    left.pair[k] = pack_bf16(a, a);
    right.pair[k] = pack_bf16(b, b);
  }
  TileSum sums[kMmaChains];
#pragma unroll
  for (int k = 0; k < kMmaChains; ++k) sums[k].clear();
  for (int i = 0; i < rounds; ++i) {
#pragma unroll
    for (int k = 0; k < kMmaChains; ++k) multiply_add(sums[k], left, right);
  }
  float total = 0;
#pragma unroll
  for (int k = 0; k < kMmaChains; ++k) {
#pragma unroll
    for (int j = 0; j < 8; ++j) total += sums[k].value[j];
  }
  out[item_index()] = total;
}

}  // namespace aligngs::cuda
