// Data of the semantic visit of a tile: its shared memory, and the Gaussians, rows and weights of a few at a time.
// Thread t handles pixel t % kPixels of a block of pixels and part t / kPixels of the Gaussians.
#pragma once

#include "device/constants.h"
#include "device/tile_mma.cuh"
#include "engine/cuda/semantic_visit.h"
#include "engine/cuda/warp_sums.cuh"
#include "engine/formulas/whitened.h"

namespace aligngs::cuda {

/// Sizes of a visit. kThreads threads visit a tile in blocks of kPixels pixels, kEntries Gaussians at a time. Each
/// block has the list of the Gaussians that it took.
template <int kPixelCount, int kThreadCount, int kEntryCount>
struct VisitForm {
  static constexpr int kPixels = kPixelCount, kThreads = kThreadCount, kEntries = kEntryCount;
  static constexpr int kBlocks = kTilePixels / kPixels;  ///< per tile
  static constexpr int kWarps = kThreads / kWarp;
  static constexpr int kParts = kThreads / kPixels;       ///< threads per pixel
  static constexpr int kPartEntries = kEntries / kParts;  ///< Gaussians per thread
  static constexpr int kPixelTiles = kPixels / kMmaTile, kEntryTiles = kEntries / kMmaTile;
  static constexpr int kColumnParts = kWarps / kPixelTiles;  ///< warps that share a row of tiles of P
  static constexpr int kWeightStride = kPixels + 8;          ///< odd multiple of 8: no bank conflicts
  static constexpr int kCouplingStride = kPixels + 4;
  static_assert(kThreads >= kTilePixels && kThreads % kPixels == 0 && kEntries % kParts == 0 && kColumnParts >= 1);
  static_assert(kPixels / kWarps <= kWarp, "a lane per pixel of a warp");

  /// The blocks of the tile that took an instance.
  __device__ __forceinline__ static unsigned blocks_of(uint8_t strips) {
    constexpr int kStrips = kPixels / kStripPixels;
    unsigned blocks = 0;
#pragma unroll
    for (int b = 0; b < kBlocks; ++b) {
      blocks |= ((unsigned(strips) >> (kStrips * b)) & ((1u << kStrips) - 1u)) != 0 ? 1u << b : 0u;
    }
    return blocks;
  }
};
using CompactedVisit = VisitForm<kBlockPixels, kVisitThreads, kVisitEntries>;
/// Two threads per pixel, a warp for 16 pixels of P. The number of Gaussians leaves room for P of 150 classes in the
/// 227 KB of sm_90.
using DenseVisit = VisitForm<kTilePixels, 512, 16>;

/// Shared memory, followed by what depends on the number of channels.
template <class Form>
struct VisitShared {
  static constexpr int kEntries = Form::kEntries, kPixels = Form::kPixels, kWarps = Form::kWarps;
  Splat splats[kEntries];
  alignas(16) Bf16 weights[kEntries * Form::kWeightStride];  ///< [entry][pixel]
  float coupling[kEntries * Form::kCouplingStride];          ///< [entry][pixel] q, then g = dL_geo/dpower
  float products[Form::kParts][kPixels];                     ///< of 1 - alpha over a part
  float behind[Form::kParts][kPixels];                       ///< what a part shows where nothing is behind it
  float transmittance[kPixels];                              ///< behind the last Gaussian
  float offset[kPixels];                                     ///< h_0
  double terms[kWarps][kSemanticTerms];
  uint32_t places[kVisitBatch];
  uint32_t entry_place[kEntries], entry_rank[kEntries], entry_slot[kEntries];
  uint8_t entry_strips[kEntries], entry_first[kEntries];
  int counts[kWarps];
  uint32_t last[kWarps], teacher[kWarps];
};

/// The arrays behind it, in bytes from the start of shared memory.
template <class Form>
struct VisitLayout {
  int padded;
  __host__ __device__ size_t blended_at() const { return (sizeof(VisitShared<Form>) + 127) / 128 * 128; }
  /// Numbers in a row of blended [kPixels]; the bfloat16 rows of dP and H share its memory.
  __host__ __device__ int blended_stride() const { return padded + 4; }
  __host__ __device__ size_t rows_at() const {
    return blended_at() + sizeof(float) * static_cast<size_t>(Form::kPixels) * static_cast<size_t>(blended_stride());
  }
  /// Stride of semantic rows [kEntries] in bfloat16; the sums [16] of dS take their place later.
  __host__ __device__ int row_stride() const { return padded + 8; }
  __host__ __device__ size_t bytes() const {
    const size_t rows = sizeof(Bf16) * static_cast<size_t>(Form::kEntries) * static_cast<size_t>(row_stride());
    const size_t sums = sizeof(float) * static_cast<size_t>(kSumRows) * static_cast<size_t>(blended_stride());
    return rows_at() + (rows > sums ? rows : sums);
  }
};

/// State that all functions of the kernel share.
template <class Form>
struct Visit {
  const SemanticVisitInputs& in;
  const SemanticVisitOutputs& out;
  VisitLayout<Form> layout;
  VisitShared<Form>& s;
  float* blended;
  Bf16* rows;
  float* sums;  ///< the same memory as rows
  int tile, tile_x, tile_y, thread, warp, lane;
  uint32_t begin;    ///< of the tile's list
  uint32_t end;      ///< places that some pixel may have taken
  unsigned teacher;  ///< bit b: some pixel of block b has a teacher

  __device__ __forceinline__ Bf16* gradient_rows() const { return reinterpret_cast<Bf16*>(blended); }
  __device__ __forceinline__ int gradient_stride() const { return 2 * layout.blended_stride(); }
  __device__ __forceinline__ int pixel() const { return thread % Form::kPixels; }
  __device__ __forceinline__ int part() const { return thread / Form::kPixels; }
};

/// The places of [first, first + kVisitBatch) that block b took, nearest first, to s.places.
template <class Form>
__device__ __forceinline__ int list_entries(const Visit<Form>& v, int b, uint32_t first) {
  int count = 0;
  for (int k = 0; k < kVisitBatch && first + k < v.end; k += Form::kThreads) {
    const uint32_t place = first + static_cast<uint32_t>(k + v.thread);
    const bool taken = place < v.end && ((Form::blocks_of(v.in.record.strips[v.begin + place]) >> b) & 1u) != 0;
    count = append(taken, place, v.s.places, count, v.s.counts);
  }
  return count;
}

/// Entries [first, first + n) of s.places to shared memory. Ends with a barrier.
template <class Form>
__device__ __forceinline__ void load_entries(const Visit<Form>& v, int b, int first, int n) {
  if (v.thread < Form::kEntries) {
    const int e = v.thread;
    v.s.entry_rank[e] = 0;
    v.s.entry_strips[e] = 0;
    if (e < n) {
      const uint32_t place = v.s.places[first + e], row = v.in.lists.gaussians[v.begin + place];
      const uint8_t strips = v.in.record.strips[v.begin + place];
      const unsigned here = Form::blocks_of(strips) & v.teacher;
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
template <class Form>
__device__ __forceinline__ void load_rows(const Visit<Form>& v, int n) {
  const int vectors = v.layout.padded / 8;  // of 8 bfloat16
  for (int k = v.thread; k < Form::kEntries * vectors; k += Form::kThreads) {
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
template <class Form>
struct PartAlphas {
  float alpha[Form::kPartEntries], slope[Form::kPartEntries];
};
template <class Form>
__device__ __forceinline__ PartAlphas<Form> part_alphas(const Visit<Form>& v, int b, int n, uint32_t pixel_last) {
  PartAlphas<Form> a;
  const int i = b * Form::kPixels + v.pixel();
  const float x = static_cast<float>(v.tile_x * kTileSize + tile_pixel_x(i)) + 0.5f;
  const float y = static_cast<float>(v.tile_y * kTileSize + tile_pixel_y(i)) + 0.5f;
  const int strip = i / kStripPixels;
  float product = 1;
#pragma unroll
  for (int k = 0; k < Form::kPartEntries; ++k) {
    const int e = v.part() * Form::kPartEntries + k;
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
template <class Form>
__device__ __forceinline__ void part_weights(const Visit<Form>& v, const PartAlphas<Form>& a, float transmittance,
                                             float (&before)[Form::kPartEntries]) {
  float t = transmittance;
  for (int q = 0; q < v.part(); ++q) t *= v.s.products[q][v.pixel()];
#pragma unroll
  for (int k = 0; k < Form::kPartEntries; ++k) {
    before[k] = t;
    v.s.weights[(v.part() * Form::kPartEntries + k) * Form::kWeightStride + v.pixel()] = to_bf16(a.alpha[k] * t);
    t *= 1 - a.alpha[k];
  }
}

template <class Form>
__device__ __forceinline__ float chunk_product(const Visit<Form>& v) {
  float product = 1;
  for (int q = 0; q < Form::kParts; ++q) product *= v.s.products[q][v.pixel()];
  return product;
}

}  // namespace aligngs::cuda
