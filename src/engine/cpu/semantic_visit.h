// The semantic visit to a tile: blended rows, loss, row gradients and coupling, block by block, without leaving the
// cache. Two ways to form the products: float32 vectors (tile_products.h) on any machine, and bfloat16 operands with
// float32 sums on AMX tiles (matrix_tiles.h).
//
// On AMX, W and S are rounded to bfloat16 (relative 2^-9 per term), and so are the gradients that re-enter products.
// The loss is formed in float32. The row gradients of a tile are one product over its 256 pixels, 32 Gaussians at a
// time. Gaussians are ordered by the set of blocks they reach, so that these products skip the blocks where none of the
// 32 has a weight.
#pragma once

#include <optional>
#include <vector>

#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/row_batches.h"
#include "engine/cpu/semantic_block.h"
#include "engine/cpu/tile_products.h"
#include "engine/cpu/tile_weights.h"

namespace aligngs::cpu {

/// The semantic part of a backward pass.
struct SemanticPass {
  SemanticStep step;
  const uint32_t* rank = nullptr;   ///< [N] index of a visible Gaussian's row in the arrays below
  const float* features = nullptr;  ///< [visible][padded] what is blended: pi or s
  /// [N][padded_depth(padded)] the same in bfloat16, s centred; not nullptr: the products use AMX tiles.
  const uint16_t* rounded = nullptr;
  float* gradients = nullptr;               ///< [visible][padded] out: dL/dfeatures where written
  std::vector<uint8_t>* written = nullptr;  ///< [visible]
  size_t visible = 0;
  double soft = 0, hard = 0;  ///< out: means over valid pixels
  bool harmless = true;       ///< out: see RowBatches::run
};

/// Scratch of one thread.
struct SemanticScratch {
  SemanticBlock block;
  AlignedArray<float> q[kTileBlocks];  ///< [rows][64]
  std::vector<const float*> rows;      ///< [entries] float rows
  std::vector<float*> row_gradients;   ///< [entries]
  StripOrder strips;
  std::vector<float*> tile_rows;  ///< [gathered splats] their sums, nullptr = not asked for yet in this tile

  std::vector<uint8_t> block_set;                 ///< [gathered splats] bit b: has a weight in block b
  std::vector<uint32_t> order, row_of;            ///< splat of a row of the tile's products and back
  std::vector<uint8_t> group_set;                 ///< of 32 rows of the tile's products: blocks that some of them reach
  std::vector<const uint16_t*> rounded;           ///< [rows] bfloat16 rows
  std::vector<const float*> weights_of_row;       ///< [rows] in the current block
  std::vector<uint32_t> block_groups;             ///< groups of 32 rows with a weight in the current block
  std::vector<uint32_t> depth_steps;              ///< 0, 1, 2, ...
  AlignedArray<uint16_t> tile_plain, tile_pairs;  ///< semantic rows as both operands, bf16_packing.h
  AlignedArray<uint16_t> weights_by_entry;        ///< [rows][256], blocks that a group does not reach unspecified
  AlignedArray<uint16_t> weights_by_pixel;        ///< [rows / 32][64][32] of the current block
  AlignedArray<uint16_t> gradient_pairs;          ///< of the tile's pixels
  AlignedArray<uint16_t> directions, direction_pairs;  ///< of the current block
  AlignedArray<float> group_sums;                      ///< [32][padded] row gradients of 32 splats of the tile
};

class SemanticVisit {
 public:
  /// All arguments outlive the visit.
  SemanticVisit(const SemanticPass& pass, const TileWeights& tile, TileRows& rows, SemanticScratch& scratch);

  /// Visits a block; scratch.block.soft and hard are its terms. Returns q of the coupling, [rows][64], valid until the
  /// next tile, or nullptr when there is none. A block without a teacher has nullptr and terms of zero.
  const float* visit_block(int block);
  /// The row of q of a splat of the tile; nullptr: that of its entry in the block.
  const uint32_t* coupling_rows() const { return pass_.rounded != nullptr ? s_.row_of.data() : nullptr; }
  /// After the last block: the tile's row gradients are in their sums.
  void finish();

 private:
  const float* visit_float(const BlockWeights& block, int index);
  const float* visit_tiles(const BlockWeights& block, int index);
  void order_by_blocks();
  void pack_tile_rows();
  void pack_block_weights(const BlockWeights& block, int index);
  void blend_pixels(size_t first, float* out) const;
  const float* coupling_direction() const;
  void row_gradients_of_group(size_t first, float* out, size_t stride);

  const SemanticPass& pass_;
  const TileWeights& tile_;
  TileRows& rows_;
  SemanticScratch& s_;
  bool has_teacher_[kTileBlocks] = {};
  std::optional<MatrixTilesInUse> tiles_;
};

/// The sums of the block's entries, zeros where they are new; scratch.tile_rows holds those found earlier in the tile.
void collect_row_gradients(const BlockWeights& block, const TileWeights& tile, TileRows& rows, SemanticScratch& s);

}  // namespace aligngs::cpu
