// What the semantic visit holds of a tile: its shared memory, and the Gaussians, rows and weights of 32 at a time.
// Thread t stands for pixel t % 64 of a block of 8 x 8 and for a quarter, t / 64, of the 32 Gaussians.
#pragma once

#include "engine/cuda/constants.h"
#include "engine/cuda/runtime/tile_mma.cuh"
#include "engine/cuda/semantic_visit.h"
#include "engine/cuda/warp_sums.cuh"
#include "engine/formulas/whitened.h"

namespace aligngs::cuda {

inline constexpr int kVisitWarps = kVisitThreads / kWarp;
inline constexpr int kVisitParts = kVisitThreads / kBlockPixels;       ///< threads per pixel
inline constexpr int kPartEntries = kVisitEntries / kVisitParts;       ///< Gaussians per thread
inline constexpr int kWeightStride = kBlockPixels + 8;                 ///< odd multiple of 8: no bank conflicts
inline constexpr int kCouplingStride = kBlockPixels + 4;

/// Shared memory, followed by what depends on the number of channels.
struct VisitShared {
  Splat splats[kVisitEntries];
  alignas(16) Bf16 weights[kVisitEntries * kWeightStride];  ///< [entry][pixel]
  float coupling[kVisitEntries * kCouplingStride];          ///< [entry][pixel] q, then g = dL_geo/dpower
  float products[kVisitParts][kBlockPixels];                ///< of 1 - alpha over a part
  float behind[kVisitParts][kBlockPixels];                  ///< what a part shows where nothing is behind it
  float transmittance[kBlockPixels];                        ///< behind the last Gaussian
  float offset[kBlockPixels];                               ///< h_0
  double terms[kVisitWarps][2];
  uint32_t places[kVisitBatch];
  uint32_t entry_place[kVisitEntries], entry_rank[kVisitEntries], entry_slot[kVisitEntries];
  uint8_t entry_strips[kVisitEntries], entry_first[kVisitEntries];
  int counts[kVisitWarps];
  uint32_t last[kVisitWarps], teacher[kVisitWarps];
};

/// The arrays behind it, in bytes from the start of shared memory.
struct VisitLayout {
  int padded;
  __host__ __device__ size_t blended_at() const { return (sizeof(VisitShared) + 127) / 128 * 128; }
  /// Numbers in a row of blended [64]; the bfloat16 rows of dP and H share its memory.
  __host__ __device__ int blended_stride() const { return padded + 4; }
  __host__ __device__ size_t rows_at() const {
    return blended_at() + sizeof(float) * static_cast<size_t>(kBlockPixels) * static_cast<size_t>(blended_stride());
  }
  /// Of semantic rows [32] in bfloat16, in whose place the sums [16] of dS stand later.
  __host__ __device__ int row_stride() const { return padded + 8; }
  __host__ __device__ size_t bytes() const {
    const size_t rows = sizeof(Bf16) * static_cast<size_t>(kVisitEntries) * static_cast<size_t>(row_stride());
    const size_t sums = sizeof(float) * static_cast<size_t>(kSumRows) * static_cast<size_t>(blended_stride());
    return rows_at() + (rows > sums ? rows : sums);
  }
};

/// What all functions of the kernel share.
struct Visit {
  const SemanticVisitInputs& in;
  const SemanticVisitOutputs& out;
  VisitLayout layout;
  VisitShared& s;
  float* blended;
  Bf16* rows;
  float* sums;        ///< the same memory as rows
  int tile, tile_x, tile_y, thread, warp, lane;
  uint32_t begin;     ///< of the tile's list
  uint32_t end;       ///< places that some pixel may have taken
  unsigned teacher;   ///< bit b: some pixel of block b has a teacher

  __device__ __forceinline__ Bf16* gradient_rows() const { return reinterpret_cast<Bf16*>(blended); }
  __device__ __forceinline__ int gradient_stride() const { return 2 * layout.blended_stride(); }
  __device__ __forceinline__ int pixel() const { return thread % kBlockPixels; }
  __device__ __forceinline__ int part() const { return thread / kBlockPixels; }
};

/// Which blocks of the tile took an instance.
__device__ __forceinline__ unsigned blocks_of(uint8_t strips) {
  unsigned blocks = 0;
#pragma unroll
  for (int b = 0; b < kTileBlocks; ++b) blocks |= ((strips >> (2 * b)) & 3u) != 0 ? 1u << b : 0u;
  return blocks;
}

/// The places of [first, first + kVisitBatch) that block b took, nearest first, to s.places.
__device__ __forceinline__ int list_entries(const Visit& v, int b, uint32_t first) {
  int count = 0;
  for (int k = 0; k < kVisitBatch && first + k < v.end; k += kVisitThreads) {
    const uint32_t place = first + static_cast<uint32_t>(k + v.thread);
    const bool taken = place < v.end && ((blocks_of(v.in.record.strips[v.begin + place]) >> b) & 1u) != 0;
    count = append(taken, place, v.s.places, count, v.s.counts);
  }
  return count;
}

/// Entries [first, first + n) of s.places to shared memory. Ends with a barrier.
__device__ __forceinline__ void load_entries(const Visit& v, int b, int first, int n) {
  if (v.thread < kVisitEntries) {
    const int e = v.thread;
    v.s.entry_rank[e] = 0;
    v.s.entry_strips[e] = 0;
    if (e < n) {
      const uint32_t place = v.s.places[first + e], row = v.in.lists.gaussians[v.begin + place];
      const uint8_t strips = v.in.record.strips[v.begin + place];
      const unsigned here = blocks_of(strips) & v.teacher;
      v.s.entry_place[e] = place;
      v.s.entry_rank[e] = v.in.lists.rank[row];
      v.s.entry_slot[e] = static_cast<uint32_t>(v.in.view.splats[row].slot(v.tile_x, v.tile_y));
      v.s.entry_strips[e] = strips;
      v.s.entry_first[e] = __ffs(static_cast<int>(here)) - 1 == b ? 1 : 0;
    }
  }
  constexpr int kVectors = sizeof(Splat) / sizeof(float4);
  if (v.thread < n * kVectors) {
    const int e = v.thread / kVectors, k = v.thread % kVectors;
    const Splat* from = &v.in.view.splats[v.in.lists.gaussians[v.begin + v.s.places[first + e]]];
    reinterpret_cast<float4*>(&v.s.splats[e])[k] = reinterpret_cast<const float4*>(from)[k];
  }
  __syncthreads();
}

/// Semantic rows of the loaded entries; zero where there is none.
__device__ __forceinline__ void load_rows(const Visit& v, int n) {
  const int vectors = v.layout.padded / 8;  // of 8 bfloat16
  for (int k = v.thread; k < kVisitEntries * vectors; k += kVisitThreads) {
    const int e = k / vectors, part = k % vectors;
    uint4 x{0, 0, 0, 0};
    if (e < n) {
      const size_t at = size_t(v.s.entry_rank[e]) * static_cast<size_t>(v.layout.padded);
      x = reinterpret_cast<const uint4*>(&v.in.rows[at])[part];
    }
    reinterpret_cast<uint4*>(v.rows + e * v.layout.row_stride())[part] = x;
  }
}

/// Alphas of this thread's pixel and entries, and their product to s.products; 0 beyond n.
struct PartAlphas {
  float alpha[kPartEntries], slope[kPartEntries];
};
__device__ __forceinline__ PartAlphas part_alphas(const Visit& v, int b, int n, uint32_t pixel_last) {
  PartAlphas a;
  const int i = b * kBlockPixels + v.pixel();
  const float x = static_cast<float>(v.tile_x * kTileSize + tile_pixel_x(i)) + 0.5f;
  const float y = static_cast<float>(v.tile_y * kTileSize + tile_pixel_y(i)) + 0.5f;
  const int strip = i / kStripPixels;
  float product = 1;
#pragma unroll
  for (int k = 0; k < kPartEntries; ++k) {
    const int e = v.part() * kPartEntries + k;
    a.alpha[k] = a.slope[k] = 0;
    if (e < n && ((v.s.entry_strips[e] >> strip) & 1u) != 0 && v.s.entry_place[e] < pixel_last) {
      const WhitenedAlpha w = whitened_alpha(v.s.splats[e], x, y, v.in.raster);
      a.alpha[k] = w.alpha;
      a.slope[k] = w.slope;
    }
    product *= 1 - a.alpha[k];
  }
  v.s.products[v.part()][v.pixel()] = product;
  return a;
}

/// Weights of this thread's entries to shared memory, given the transmittance before all 32; before[k] is that before
/// entry k. After the barrier behind part_alphas.
__device__ __forceinline__ void part_weights(const Visit& v, const PartAlphas& a, float transmittance,
                                             float (&before)[kPartEntries]) {
  float t = transmittance;
  for (int q = 0; q < v.part(); ++q) t *= v.s.products[q][v.pixel()];
#pragma unroll
  for (int k = 0; k < kPartEntries; ++k) {
    before[k] = t;
    v.s.weights[(v.part() * kPartEntries + k) * kWeightStride + v.pixel()] = to_bf16(a.alpha[k] * t);
    t *= 1 - a.alpha[k];
  }
}

__device__ __forceinline__ float chunk_product(const Visit& v) {
  float product = 1;
  for (int q = 0; q < kVisitParts; ++q) product *= v.s.products[q][v.pixel()];
  return product;
}

}  // namespace aligngs::cuda
