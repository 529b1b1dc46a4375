// The semantic loss of 32 pixels, from blended rows to the bfloat16 operands of the next products (matrix_tiles.h), so
// that neither leaves the nearest cache. Formulas: engine/formulas/semantic_loss.h. Logarithms are within 1e-5 and
// reciprocals within 2^-14: the blended rows have 8 bits, and so have the results.
#pragma once

#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/semantic_block.h"

namespace aligngs::cpu {

inline constexpr size_t kHalfBlockPixels = kBlockPixels / 2;

/// Operands of the products over pixels and over channels.
struct HalfBlockOutputs {
  uint16_t* gradient_pairs;  ///< row gradients as pack_pixels lays out 32 pixels
  uint16_t* directions;      ///< [32][depth] coupling directions
  size_t depth;              ///< padded_depth (bf16_packing.h)
};

/// Prepares the teacher of a block and sets soft and hard to zero. False where only semantic_block_loss knows the loss:
/// another blend than probabilities, or a teacher that is not known everywhere under the block.
bool begin_half_blocks(const SemanticStep& step, const BlockWeights& block, SemanticBlock& scratch);

/// Pixels [first, first + 32) of the block, whose blended rows are scratch.blended [32][padded]. Adds to soft and hard,
/// sets scratch.offset of these pixels and writes `out`; pixels without a loss are zero.
void half_block_loss(const SemanticStep& step, const BlockWeights& block, size_t first, SemanticBlock& scratch,
                     const HalfBlockOutputs& out);

}  // namespace aligngs::cpu
