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

/// Weights as A of a product over entries: out[entry / 32][pixel][entry % 32]; entries beyond the count are zero.
void pack_weights_by_pixel(const BlockWeights& block, uint16_t* out);

/// The 64 weights of each entry, to out + row_of[block.entry[e]] * row_stride.
void pack_weights_by_entry(const BlockWeights& block, const uint32_t* row_of, size_t row_stride, uint16_t* out);

/// Semantic rows (bfloat16, [padded_depth(padded)]) of a block's entries as B of a product over entries:
/// [entry / 32][channel / 16][pair of entries][channel % 16][2]; entries beyond the count are zero.
void pack_row_pairs(const uint16_t* const* rows, size_t count, size_t padded, uint16_t* out);

/// The rows of up to 32 entries one behind the other, [32][depth], as A of a product over channels; those beyond the
/// count are zero.
void copy_rows(const uint16_t* const* rows, size_t count, size_t depth, uint16_t* out);

/// Float rows of 64 pixels, [64][padded], as B of a product over pixels: [pixel / 32][channel / 16][pair][16][2].
void pack_pixels(const float* in, size_t padded, uint16_t* out);

/// The same as B of a product over channels: [channel / 32][pixel / 16][pair of channels][pixel % 16][2]; channels
/// beyond `padded` are zero.
void pack_pixels_transposed(const float* in, size_t padded, uint16_t* out);

}  // namespace aligngs::cpu
