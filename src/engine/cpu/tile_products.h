// The three matrix products of the semantics, per block of 64 pixels, in float32. With W the block's weights
// [entries x 64] and S the semantic rows of its entries [entries x C]:
//   P = W^T S (blended rows), dS = W dP (row gradients), Q = S H^T (coupling).
// The bfloat16 versions are in matrix_tiles.h.
#pragma once

#include <cstddef>

#include "engine/cpu/tile_weights.h"

namespace aligngs::cpu {

/// Semantic rows are padded with zeros to a multiple of this many floats: one cache line.
inline constexpr int kChannelPadding = 16;
inline size_t padded_channels(int channels) {
  return static_cast<size_t>((channels + kChannelPadding - 1) / kChannelPadding * kChannelPadding);
}

/// A block's entries by the strips of pixels that they reach, so that the products skip strips without weights: about a
/// third of them.
struct StripOrder {
  AlignedArray<uint32_t> of_strip[kBlockPixels / kStripPixels];  ///< entries with a weight in the strip, nearest first
  AlignedArray<uint32_t> by_strips;                              ///< [count] entries, those of equal strips together
};
void order_by_strips(const BlockWeights& block, StripOrder& order);

/// blended[64][padded] = W^T S. rows[e] is the padded row of entry e, 64-byte aligned.
void block_blend_rows(const BlockWeights& block, const StripOrder& order, const float* const* rows, size_t padded,
                      float* blended);

/// gradient_rows[e][0..padded) += sum over pixels of w_e dblended[pixel].
void block_row_gradients(const BlockWeights& block, const StripOrder& order, const float* dblended, size_t padded,
                         float* const* gradient_rows);

/// q[e][64] = rows[e] . direction[pixel] - offset[pixel] in the strips of e, elsewhere unspecified; `transposed` is the
/// direction as [padded][64].
void block_coupling(const BlockWeights& block, const StripOrder& order, const float* const* rows, size_t padded,
                    const float* transposed, const float* offset, float* q);

/// [64][padded] to [padded][64].
void block_transpose(const float* in, size_t padded, float* out);

}  // namespace aligngs::cpu
