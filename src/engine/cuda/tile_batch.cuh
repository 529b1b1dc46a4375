// Gaussians of a tile in shared memory, a batch at a time, and which of its strips each of them can reach.
#pragma once

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "engine/cuda/view_spans.h"
#include "engine/formulas/overlap.h"

namespace aligngs::cuda {

/// Left and top pixel of strip s within its tile; a strip is 8 x 4 pixels.
__device__ __forceinline__ int strip_x(int s) { return (s / 2 % 2) * kBlockSize; }
__device__ __forceinline__ int strip_y(int s) { return (s / 4) * kBlockSize + (s % 2) * (kStripPixels / kBlockSize); }

/// Bit s: the Gaussian can reach strip s of the tile at (left, top).
__device__ inline uint32_t reached_strips(const Splat& g, int left, int top) {
  uint32_t bits = 0;
  for (int s = 0; s < kTileStrips; ++s) {
    const bool hit = reaches_box(g, static_cast<float>(left + strip_x(s)), static_cast<float>(top + strip_y(s)),
                                 static_cast<float>(kBlockSize), static_cast<float>(kStripPixels / kBlockSize));
    bits |= hit ? 1u << s : 0u;
  }
  return bits;
}

/// In shared memory.
struct TileBatch {
  Splat splats[kBlendBatch];
  uint32_t strips[kBlendBatch];  ///< of reached_strips
};

/// One thread of the block per Gaussian; barriers are the caller's.
__device__ inline void load_batch(const ViewSpans& view, const TileListSpans& lists, uint32_t first, uint32_t count,
                                  int left, int top, TileBatch& batch) {
  const unsigned t = thread_rank();
  if (t >= count) return;
  const Splat& from = view.splats[lists.gaussians[first + t]];
  static_assert(sizeof(Splat) % sizeof(float4) == 0, "copied in vectors");
  const float4* source = reinterpret_cast<const float4*>(&from);
  float4* target = reinterpret_cast<float4*>(&batch.splats[t]);
  for (size_t k = 0; k < sizeof(Splat) / sizeof(float4); ++k) target[k] = source[k];
  batch.strips[t] = reached_strips(batch.splats[t], left, top);
}

/// A pixel on its way through the list.
struct PixelBlend {
  float transmittance = 1;
  bool open = true;

  /// True: this pixel takes the Gaussian, with `weight`. False for good once one would close it.
  __device__ __forceinline__ bool take(float alpha, bool wanted, float transmittance_min, float& weight) {
    if (!open || !wanted) return false;
    const float next = std::fma(-alpha, transmittance, transmittance);
    if (!(next >= transmittance_min)) {
      open = false;
      return false;
    }
    weight = alpha * transmittance;
    transmittance = next;
    return true;
  }
};

}  // namespace aligngs::cuda
