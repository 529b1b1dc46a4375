#include "engine/cpu/tile_products.h"

#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/tile_products.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

// Register tiles: kRows x kColumns accumulators, one broadcast and kColumns operands. 24 of the 32 registers of
// AVX-512, 12 of the 16 of AVX2 and SSE.
constexpr bool kManyRegisters = HWY_MAX_BYTES >= 64;
constexpr size_t kRows = kManyRegisters ? 8 : 4;
constexpr size_t kColumns = 3;

/// blended[pixel .. pixel + kRows)[channel ..] over the entries with a weight in the strip.
template <size_t kVectors>
HWY_INLINE void blend_rows_tile(const BlockWeights& block, const AlignedArray<uint32_t>& entries,
                                const float* const* rows, size_t padded, size_t pixel, size_t channel, float* blended) {
  static_assert(kStripPixels % kRows == 0, "the pixels of a register tile share a strip");
  const FloatTag d;
  FloatVec sum[kRows][kVectors];
  for (size_t m = 0; m < kRows; ++m) {
    for (size_t v = 0; v < kVectors; ++v) sum[m][v] = hn::Zero(d);
  }
  for (size_t k = 0; k < entries.size(); ++k) {
    const size_t e = entries[k];
    const float* HWY_RESTRICT weight = block.weight.data() + e * kBlockPixels + pixel;
    const float* HWY_RESTRICT row = rows[e] + channel;
    FloatVec b[kVectors];
    for (size_t v = 0; v < kVectors; ++v) b[v] = hn::Load(d, row + v * kLanes);
    for (size_t m = 0; m < kRows; ++m) {
      const FloatVec w = hn::Set(d, weight[m]);
      for (size_t v = 0; v < kVectors; ++v) sum[m][v] = hn::MulAdd(w, b[v], sum[m][v]);
    }
  }
  for (size_t m = 0; m < kRows; ++m) {
    for (size_t v = 0; v < kVectors; ++v) {
      hn::Store(sum[m][v], d, blended + (pixel + m) * padded + channel + v * kLanes);
    }
  }
}

template <size_t kVectors>
void blend_rows_columns(const BlockWeights& block, const StripOrder& order, const float* const* rows, size_t padded,
                        size_t channel, float* blended) {
  for (size_t pixel = 0; pixel < kBlockPixels; pixel += kRows) {
    blend_rows_tile<kVectors>(block, order.of_strip[pixel / kStripPixels], rows, padded, pixel, channel, blended);
  }
}

void BlockBlendRows(const BlockWeights& block, const StripOrder& order, const float* const* rows, size_t padded,
                    float* blended) {
  size_t channel = 0;
  for (; channel + kColumns * kLanes <= padded; channel += kColumns * kLanes) {
    blend_rows_columns<kColumns>(block, order, rows, padded, channel, blended);
  }
  for (; channel + 2 * kLanes <= padded; channel += 2 * kLanes) {
    blend_rows_columns<2>(block, order, rows, padded, channel, blended);
  }
  for (; channel < padded; channel += kLanes) blend_rows_columns<1>(block, order, rows, padded, channel, blended);
}

/// gradient_rows of `kEntries` entries, [channel ..], over the pixels of their strips.
template <size_t kEntries, size_t kVectors>
HWY_INLINE void row_gradients_tile(const BlockWeights& block, const uint32_t* HWY_RESTRICT entries,
                                   const float* HWY_RESTRICT dblended, size_t padded, size_t channel,
                                   float* const* gradient_rows) {
  const FloatTag d;
  FloatVec sum[kEntries][kVectors];
  const float* weight[kEntries];
  uint32_t strips = 0;
  for (size_t m = 0; m < kEntries; ++m) {
    const uint32_t e = entries[m];
    strips |= block.strips[e];
    weight[m] = block.weight.data() + size_t(e) * kBlockPixels;
    for (size_t v = 0; v < kVectors; ++v) sum[m][v] = hn::Load(d, gradient_rows[e] + channel + v * kLanes);
  }
  for (size_t strip = 0; strip < kBlockPixels / kStripPixels; ++strip) {
    if (((strips >> strip) & 1u) == 0) continue;
    const float* HWY_RESTRICT operand = dblended + strip * kStripPixels * padded + channel;
    for (size_t pixel = strip * kStripPixels; pixel < (strip + 1) * kStripPixels; ++pixel, operand += padded) {
      FloatVec b[kVectors];
      for (size_t v = 0; v < kVectors; ++v) b[v] = hn::Load(d, operand + v * kLanes);
      for (size_t m = 0; m < kEntries; ++m) {
        const FloatVec w = hn::Set(d, weight[m][pixel]);
        for (size_t v = 0; v < kVectors; ++v) sum[m][v] = hn::MulAdd(w, b[v], sum[m][v]);
      }
    }
  }
  for (size_t m = 0; m < kEntries; ++m) {
    for (size_t v = 0; v < kVectors; ++v) hn::Store(sum[m][v], d, gradient_rows[entries[m]] + channel + v * kLanes);
  }
}

template <size_t kVectors>
void row_gradients_columns(const BlockWeights& block, const StripOrder& order, const float* dblended, size_t padded,
                           size_t channel, float* const* gradient_rows) {
  size_t k = 0;
  for (; k + kRows <= block.count; k += kRows) {
    row_gradients_tile<kRows, kVectors>(block, order.by_strips.data() + k, dblended, padded, channel, gradient_rows);
  }
  for (; k < block.count; ++k) {
    row_gradients_tile<1, kVectors>(block, order.by_strips.data() + k, dblended, padded, channel, gradient_rows);
  }
}

void BlockRowGradients(const BlockWeights& block, const StripOrder& order, const float* dblended, size_t padded,
                       float* const* gradient_rows) {
  size_t channel = 0;
  for (; channel + kColumns * kLanes <= padded; channel += kColumns * kLanes) {
    row_gradients_columns<kColumns>(block, order, dblended, padded, channel, gradient_rows);
  }
  for (; channel + 2 * kLanes <= padded; channel += 2 * kLanes) {
    row_gradients_columns<2>(block, order, dblended, padded, channel, gradient_rows);
  }
  for (; channel < padded; channel += kLanes)
    row_gradients_columns<1>(block, order, dblended, padded, channel, gradient_rows);
}

/// q of `kEntries` entries, [pixel ..], over all channels.
template <size_t kEntries, size_t kVectors>
HWY_INLINE void coupling_tile(const uint32_t* HWY_RESTRICT entries, const float* const* all_rows, size_t padded,
                              const float* HWY_RESTRICT transposed, const float* HWY_RESTRICT offset, size_t pixel,
                              float* HWY_RESTRICT q) {
  const FloatTag d;
  FloatVec sum[kEntries][kVectors];
  const float* rows[kEntries];
  for (size_t m = 0; m < kEntries; ++m) {
    rows[m] = all_rows[entries[m]];
    for (size_t v = 0; v < kVectors; ++v) sum[m][v] = hn::Neg(hn::Load(d, offset + pixel + v * kLanes));
  }
  const float* HWY_RESTRICT operand = transposed + pixel;
  for (size_t c = 0; c < padded; ++c, operand += kBlockPixels) {
    FloatVec b[kVectors];
    for (size_t v = 0; v < kVectors; ++v) b[v] = hn::Load(d, operand + v * kLanes);
    for (size_t m = 0; m < kEntries; ++m) {
      const FloatVec s = hn::Set(d, rows[m][c]);
      for (size_t v = 0; v < kVectors; ++v) sum[m][v] = hn::MulAdd(s, b[v], sum[m][v]);
    }
  }
  for (size_t m = 0; m < kEntries; ++m) {
    for (size_t v = 0; v < kVectors; ++v)
      hn::Store(sum[m][v], d, q + size_t(entries[m]) * kBlockPixels + pixel + v * kLanes);
  }
}

void BlockCoupling(const BlockWeights& block, const StripOrder& order, const float* const* rows, size_t padded,
                   const float* transposed, const float* offset, float* q) {
  // One strip, or for long vectors the whole block: fewer loads per product, but also pixels without weights.
  constexpr size_t kVectors = kManyRegisters ? 4 : kStripPixels / kLanes < 2 ? 1 : 2, kPixels = kVectors * kLanes;
  constexpr size_t kEntries = kManyRegisters ? 6 : 5;
  static_assert(kBlockPixels % kPixels == 0);
  for (size_t pixel = 0; pixel < kBlockPixels; pixel += kPixels) {
    const bool one_strip = kPixels <= static_cast<size_t>(kStripPixels);
    const AlignedArray<uint32_t>& entries = one_strip ? order.of_strip[pixel / kStripPixels] : order.by_strips;
    size_t k = 0;
    for (; k + kEntries <= entries.size(); k += kEntries) {
      coupling_tile<kEntries, kVectors>(entries.data() + k, rows, padded, transposed, offset, pixel, q);
    }
    for (; k < entries.size(); ++k) {
      coupling_tile<1, kVectors>(entries.data() + k, rows, padded, transposed, offset, pixel, q);
    }
  }
}

void BlockTranspose(const float* in, size_t padded, float* out) {
#if HWY_TARGET == HWY_SCALAR
  for (size_t pixel = 0; pixel < kBlockPixels; ++pixel) {
    for (size_t c = 0; c < padded; ++c) out[c * kBlockPixels + pixel] = in[pixel * padded + c];
  }
#else
  const HWY_CAPPED(float, 4) d;
  const hn::Repartition<double, decltype(d)> dd;
  for (size_t c = 0; c < padded; c += 4) {
    for (size_t pixel = 0; pixel < kBlockPixels; pixel += 4) {
      const float* from = in + pixel * padded + c;
      const auto r0 = hn::Load(d, from), r1 = hn::Load(d, from + padded), r2 = hn::Load(d, from + 2 * padded),
                 r3 = hn::Load(d, from + 3 * padded);
      const auto a = hn::BitCast(dd, hn::InterleaveLower(d, r0, r1)),
                 b = hn::BitCast(dd, hn::InterleaveLower(d, r2, r3));
      const auto e = hn::BitCast(dd, hn::InterleaveUpper(d, r0, r1)),
                 f = hn::BitCast(dd, hn::InterleaveUpper(d, r2, r3));
      float* to = out + c * kBlockPixels + pixel;
      hn::Store(hn::BitCast(d, hn::InterleaveLower(dd, a, b)), d, to);
      hn::Store(hn::BitCast(d, hn::InterleaveUpper(dd, a, b)), d, to + kBlockPixels);
      hn::Store(hn::BitCast(d, hn::InterleaveLower(dd, e, f)), d, to + 2 * kBlockPixels);
      hn::Store(hn::BitCast(d, hn::InterleaveUpper(dd, e, f)), d, to + 3 * kBlockPixels);
    }
  }
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(BlockBlendRows);
HWY_EXPORT(BlockRowGradients);
HWY_EXPORT(BlockCoupling);
HWY_EXPORT(BlockTranspose);

void order_by_strips(const BlockWeights& block, StripOrder& order) {
  constexpr size_t kStrips = kBlockPixels / kStripPixels, kSets = size_t(1) << kStrips;
  size_t begin[kSets + 1] = {}, counts[kStrips] = {};
  for (size_t e = 0; e < block.count; ++e) ++begin[block.strips[e] + size_t(1)];
  for (size_t set = 1; set <= kSets; ++set) begin[set] += begin[set - 1];
  order.by_strips.resize(block.count);
  for (AlignedArray<uint32_t>& entries : order.of_strip) entries.resize(block.count);
  for (uint32_t e = 0; e < block.count; ++e) {
    order.by_strips[begin[block.strips[e]]++] = e;
    for (size_t strip = 0; strip < kStrips; ++strip) {
      if (((block.strips[e] >> strip) & 1u) != 0) order.of_strip[strip][counts[strip]++] = e;
    }
  }
  for (size_t strip = 0; strip < kStrips; ++strip) order.of_strip[strip].resize(counts[strip]);
}

void block_blend_rows(const BlockWeights& block, const StripOrder& order, const float* const* rows, size_t padded,
                      float* blended) {
  HWY_DYNAMIC_DISPATCH(BlockBlendRows)(block, order, rows, padded, blended);
}
void block_row_gradients(const BlockWeights& block, const StripOrder& order, const float* dblended, size_t padded,
                         float* const* gradient_rows) {
  HWY_DYNAMIC_DISPATCH(BlockRowGradients)(block, order, dblended, padded, gradient_rows);
}
void block_coupling(const BlockWeights& block, const StripOrder& order, const float* const* rows, size_t padded,
                    const float* transposed, const float* offset, float* q) {
  HWY_DYNAMIC_DISPATCH(BlockCoupling)(block, order, rows, padded, transposed, offset, q);
}
void block_transpose(const float* in, size_t padded, float* out) {
  HWY_DYNAMIC_DISPATCH(BlockTranspose)(in, padded, out);
}

}  // namespace aligngs::cpu
#endif
