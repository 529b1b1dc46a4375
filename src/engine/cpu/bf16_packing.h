// Float32 blocks to the bfloat16 operands of matrix_tiles.h, rounded to nearest. Only with matrix_tiles_available().
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/cpu/tile_weights.h"

namespace aligngs::cpu {

/// Entries rounded up to whole steps of a product over entries.
inline size_t padded_entries(size_t count) { return (count + 31) / 32 * 32; }
/// Channels rounded up to whole steps of a product over channels.
inline size_t padded_depth(size_t padded) { return (padded + 31) / 32 * 32; }

/// The 64 weights of each of 32 entries, as A of a product over pixels (by_entry + entry * row_stride) and as A of a
/// product over entries (by_pixel[64][32]).
void pack_weights(const float* const* weights, size_t row_stride, uint16_t* by_entry, uint16_t* by_pixel);

/// Semantic rows (bfloat16, [padded_depth(padded)]): one behind the other as A of products over channels, [count
/// rounded up][depth], and as B of products over entries, [entry / 32][channel / 16][pair of entries][channel % 16][2].
/// Entries beyond the count are zero.
void pack_rows(const uint16_t* const* rows, size_t count, size_t padded, uint16_t* plain, uint16_t* pairs);

/// Float rows of 64 pixels, [64][padded], as B of a product over pixels: [pixel / 32][channel / 16][pair][16][2].
void pack_pixels(const float* in, size_t padded, uint16_t* out);

/// The same rounded and left in order, [64][padded_depth(padded)].
void round_pixels(const float* in, size_t padded, uint16_t* out);

/// Rounded rows of 64 pixels, [64][depth], as B of a product over channels:
/// [channel / 32][pixel / 16][pair of channels][pixel % 16][2].
void pack_pixels_transposed(const uint16_t* in, size_t depth, uint16_t* out);

}  // namespace aligngs::cpu
