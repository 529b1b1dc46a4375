#include "engine/cpu/semantic_visit.h"

#include <algorithm>
#include <cstring>

#include "engine/cpu/bf16_packing.h"
#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/tile_products.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kGroup = 32;                                  ///< rows of a tile product
constexpr size_t kStepsPerBlock = kBlockPixels / kTileDepth;   ///< of a product over pixels

/// Order of the sets of blocks: neighbours in a Gray code differ by one block, so that 32 Gaussians of neighbouring
/// sets reach few blocks together.
constexpr size_t kBlockSets = size_t(1) << kTileBlocks;
struct SetOrder {
  uint8_t place[kBlockSets] = {};
  constexpr SetOrder() {
    for (size_t i = 0; i < kBlockSets; ++i) place[i ^ (i >> 1)] = static_cast<uint8_t>(i);
  }
};
constexpr SetOrder kPlaceOfSet;

/// Calls the kernel for all 16-column groups of C and B.
void tile_product_columns(TileProduct p, size_t columns) {
  for (; columns >= 2 * kTileRows; columns -= 2 * kTileRows) {
    tile_product_32(p);
    p.b += 2 * kTileNumbers;
    p.c += 2 * kTileRows;
    if (p.initial != nullptr) p.initial += 2 * kTileRows;
  }
  if (columns > 0) tile_product_16(p);
}

}  // namespace

void collect_row_gradients(const BlockWeights& block, const TileWeights& tile, TileRows& rows, SemanticScratch& s) {
  s.row_gradients.resize(block.count);
  for (size_t e = 0; e < block.count; ++e) {
    float*& row = s.tile_rows[block.entry[e]];
    if (row == nullptr) row = rows.sums_of(tile.rows[block.entry[e]]);
    s.row_gradients[e] = row;
  }
}

SemanticVisit::SemanticVisit(const SemanticPass& pass, const TileWeights& tile, TileRows& rows,
                             SemanticScratch& scratch)
    : pass_(pass), tile_(tile), rows_(rows), s_(scratch) {
  for (int b = 0; b < kTileBlocks; ++b) has_teacher_[b] = block_has_teacher(pass.step, tile.blocks[b]);
  s_.block.blended.resize(kBlockPixels * pass.step.padded);
  if (pass.rounded == nullptr) {
    s_.tile_rows.assign(tile.count, nullptr);
    return;
  }
  const size_t depth = padded_depth(pass.step.padded);
  s_.tile_rounded.resize(tile.count);
  for (size_t i = 0; i < tile.count; ++i) s_.tile_rounded[i] = pass.rounded + size_t(pass.rank[tile.rows[i]]) * depth;
  order_by_blocks();
}

/// Sorts the splats that take part by the set of their blocks and writes their weights in that order.
void SemanticVisit::order_by_blocks() {
  s_.block_set.assign(tile_.count, 0);
  size_t most = 0;
  for (int b = 0; b < kTileBlocks; ++b) {
    if (!has_teacher_[b]) continue;
    const BlockWeights& block = tile_.blocks[b];
    most = std::max(most, block.count);
    for (size_t e = 0; e < block.count; ++e) s_.block_set[block.entry[e]] |= static_cast<uint8_t>(1u << b);
  }
  size_t begin[kBlockSets + 1] = {};
  for (size_t i = 0; i < tile_.count; ++i) ++begin[kPlaceOfSet.place[s_.block_set[i]] + size_t(1)];
  begin[1] = 0;  // splats without any weight take no part
  for (size_t place = 1; place <= kBlockSets; ++place) begin[place] += begin[place - 1];
  const size_t taking_part = begin[kBlockSets];
  s_.order.resize(taking_part);
  s_.row_of.resize(tile_.count);
  for (size_t i = 0; i < tile_.count; ++i) {
    const uint8_t set = s_.block_set[i];
    if (set == 0) continue;
    const size_t row = begin[kPlaceOfSet.place[set]]++;
    s_.order[row] = static_cast<uint32_t>(i);
    s_.row_of[i] = static_cast<uint32_t>(row);
  }
  const size_t rows = padded_entries(taking_part);
  s_.weights_by_entry.resize(rows * kTilePixels);
  s_.group_set.resize(rows / kGroup);
  for (size_t first = 0; first < rows; first += kGroup) {
    uint8_t all = 0;
    for (size_t row = first; row < std::min(first + kGroup, taking_part); ++row) all |= s_.block_set[s_.order[row]];
    s_.group_set[first / kGroup] = all;
    for (size_t row = first; row < first + kGroup; ++row) {  // zeros where others of the group have weights
      const unsigned missing = row < taking_part ? all & ~unsigned(s_.block_set[s_.order[row]]) : all;
      for (int b = 0; b < kTileBlocks; ++b) {
        if (((missing >> b) & 1u) == 0) continue;
        std::memset(s_.weights_by_entry.data() + row * kTilePixels + b * kBlockPixels, 0,
                    kBlockPixels * sizeof(uint16_t));
      }
    }
  }
  const size_t steps = std::max({padded_entries(most) / kTileDepth, padded_depth(pass_.step.padded) / kTileDepth});
  while (s_.steps.size() < steps) s_.steps.push_back(static_cast<uint32_t>(s_.steps.size()));
  s_.gradient_pairs.resize(kTilePixels * pass_.step.padded);
}

const float* SemanticVisit::visit_block(int index) {
  s_.block.soft = s_.block.hard = 0;
  if (!has_teacher_[index]) return nullptr;
  const BlockWeights& block = tile_.blocks[index];
  return pass_.rounded != nullptr ? visit_tiles(block, index) : visit_float(block, index);
}

const float* SemanticVisit::coupling_direction() const {
  const bool bounded = pass_.step.losses->coupling == SemanticCoupling::kBounded;
  return bounded ? s_.block.direction.data() : s_.block.blended.data();
}

const float* SemanticVisit::visit_float(const BlockWeights& block, int index) {
  const size_t padded = pass_.step.padded;
  s_.rows.resize(block.count);
  for (size_t e = 0; e < block.count; ++e) {
    s_.rows[e] = pass_.features + size_t(pass_.rank[tile_.rows[block.entry[e]]]) * padded;
  }
  order_by_strips(block, s_.strips);
  block_blend_rows(block, s_.strips, s_.rows.data(), padded, s_.block.blended.data());
  semantic_block_loss(pass_.step, block, s_.block);
  if (block.count == 0) return nullptr;
  collect_row_gradients(block, tile_, rows_, s_);
  block_row_gradients(block, s_.strips, s_.block.blended.data(), padded, s_.row_gradients.data());
  if (!pass_.step.couple) return nullptr;
  s_.block.transposed.resize(kBlockPixels * padded);
  block_transpose(coupling_direction(), padded, s_.block.transposed.data());
  AlignedArray<float>& q = s_.q[index];
  q.resize(block.count * kBlockPixels);
  block_coupling(block, s_.strips, s_.rows.data(), padded, s_.block.transposed.data(), s_.block.offset, q.data());
  return q.data();
}

const float* SemanticVisit::visit_tiles(const BlockWeights& block, int index) {
  const size_t padded = pass_.step.padded, depth = padded_depth(padded), entries = padded_entries(block.count);
  const MatrixTilesInUse tiles;
  s_.rounded.resize(block.count);
  for (size_t e = 0; e < block.count; ++e) s_.rounded[e] = s_.tile_rounded[block.entry[e]];
  s_.weights_by_pixel.resize(entries * kBlockPixels);
  s_.row_pairs.resize(entries * padded);
  pack_weights_by_entry(block, s_.row_of.data(), kTilePixels, s_.weights_by_entry.data() + index * kBlockPixels);
  pack_weights_by_pixel(block, s_.weights_by_pixel.data());
  pack_row_pairs(s_.rounded.data(), block.count, padded, s_.row_pairs.data());

  TileProduct blend;  // P = W^T S
  blend.a_row = kTileDepth;
  blend.a_step = kTileDepth * kBlockPixels;
  blend.b_step = kTileDepth * padded;
  blend.steps = s_.steps.data();
  blend.step_count = entries / kTileDepth;
  blend.c_row = padded;
  for (size_t column = 0; column < padded; column += kGroup) {  // B of the columns stays in the nearest cache
    blend.b = s_.row_pairs.data() + column * kTileDepth;
    for (size_t pixel = 0; pixel < kBlockPixels; pixel += kGroup) {
      blend.a = s_.weights_by_pixel.data() + pixel * kTileDepth;
      blend.c = s_.block.blended.data() + pixel * padded + column;
      tile_product_columns(blend, std::min(kGroup, padded - column));
    }
  }
  semantic_block_loss(pass_.step, block, s_.block);
  pack_pixels(s_.block.blended.data(), padded, s_.gradient_pairs.data() + size_t(index) * kBlockPixels * padded);
  if (block.count == 0 || !pass_.step.couple) return nullptr;

  TileProduct coupling;  // Q = S H^T - h_0
  s_.rows_of_group.resize(kGroup * depth);
  s_.direction_pairs.resize(kBlockPixels * depth);
  pack_pixels_transposed(coupling_direction(), padded, s_.direction_pairs.data());
  AlignedArray<float>& q = s_.q[index];
  q.resize(entries * kBlockPixels);
  for (float& offset : s_.block.offset) offset = -offset;
  coupling.a_row = depth;
  coupling.a_step = kTileDepth;
  coupling.b = s_.direction_pairs.data();
  coupling.b_step = kTileDepth * kBlockPixels;
  coupling.steps = s_.steps.data();
  coupling.step_count = depth / kTileDepth;
  coupling.initial = s_.block.offset;
  coupling.c_row = kBlockPixels;
  for (size_t e = 0; e < entries; e += kGroup) {
    copy_rows(s_.rounded.data() + e, std::min(kGroup, block.count - e), depth, s_.rows_of_group.data());
    coupling.a = s_.rows_of_group.data();
    coupling.c = q.data() + e * kBlockPixels;
    tile_product_columns(coupling, kBlockPixels);
  }
  return q.data();
}

/// Sums of rows [first, first + 32) of the tile's product: dS = W dP over the blocks that some of them reach.
void SemanticVisit::row_gradients_of_group(size_t first, float* out, size_t stride) {
  const size_t padded = pass_.step.padded;
  const unsigned set = s_.group_set[first / kGroup];
  uint32_t steps[kTileBlocks * kStepsPerBlock];
  TileProduct p;
  for (uint32_t b = 0; b < kTileBlocks; ++b) {
    for (uint32_t k = 0; k < kStepsPerBlock && ((set >> b) & 1u) != 0; ++k) {
      steps[p.step_count++] = b * static_cast<uint32_t>(kStepsPerBlock) + k;
    }
  }
  p.a = s_.weights_by_entry.data() + first * kTilePixels;
  p.a_row = kTilePixels;
  p.a_step = kTileDepth;
  p.b = s_.gradient_pairs.data();
  p.b_step = kTileDepth * padded;
  p.steps = steps;
  p.c = out;
  p.c_row = stride;
  tile_product_columns(p, padded);
}

void SemanticVisit::finish() {
  if (pass_.rounded == nullptr || s_.order.empty()) return;
  const size_t padded = pass_.step.padded, count = s_.order.size();
  const MatrixTilesInUse tiles;
  s_.group_sums.resize(kGroup * padded);
  for (size_t first = 0; first < count; first += kGroup) {
    float* rows[kGroup];
    const size_t n = std::min(kGroup, count - first);
    for (size_t i = 0; i < n; ++i) rows[i] = rows_.sums_of(tile_.rows[s_.order[first + i]]);
    row_gradients_of_group(first, s_.group_sums.data(), padded);
    for (size_t i = 0; i < n; ++i) add_row(s_.group_sums.data() + i * padded, padded, rows[i]);
  }
}

}  // namespace aligngs::cpu
