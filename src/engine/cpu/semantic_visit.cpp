#include "engine/cpu/semantic_visit.h"

#include <algorithm>
#include <cstring>

#include "engine/cpu/bf16_packing.h"
#include "engine/cpu/matrix_tiles.h"
#include "engine/cpu/semantic_half_block.h"
#include "engine/cpu/semantic_rows.h"
#include "engine/cpu/tile_products.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kGroup = 32;                                 ///< rows of a tile product
constexpr size_t kStepsPerBlock = kBlockPixels / kTileDepth;  ///< of a product over pixels

/// Order of the sets of blocks: neighbours in a Gray code differ by one block. 32 Gaussians of neighbouring sets hence
/// reach few blocks together.
constexpr size_t kBlockSets = size_t(1) << kTileBlocks;
struct SetOrder {
  uint8_t place[kBlockSets] = {};
  constexpr SetOrder() {
    for (size_t i = 0; i < kBlockSets; ++i) place[i ^ (i >> 1)] = static_cast<uint8_t>(i);
  }
};
constexpr SetOrder kPlaceOfSet;

/// The weights of an entry that a block does not have.
alignas(64) constexpr float kNoWeights[kBlockPixels] = {};

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
  order_by_blocks();
  pack_tile_rows();
  tiles_.emplace();
}

/// Sorts the splats that take part by the set of their blocks.
void SemanticVisit::order_by_blocks() {
  s_.block_set.assign(tile_.count, 0);
  for (int b = 0; b < kTileBlocks; ++b) {
    if (!has_teacher_[b]) continue;
    const BlockWeights& block = tile_.blocks[b];
    for (size_t e = 0; e < block.count; ++e) s_.block_set[block.entry[e]] |= static_cast<uint8_t>(1u << b);
  }
  size_t begin[kBlockSets + 1] = {};
  for (size_t i = 0; i < tile_.count; ++i) ++begin[kPlaceOfSet.place[s_.block_set[i]] + size_t(1)];
  begin[1] = 0;  // splats without any weight take no part
  for (size_t place = 1; place <= kBlockSets; ++place) begin[place] += begin[place - 1];
  const size_t taking_part = begin[kBlockSets];
  s_.order.resize(taking_part + 1);  // those without a weight are written behind the others
  s_.row_of.resize(tile_.count);
  for (size_t i = 0; i < tile_.count; ++i) {
    const uint8_t set = s_.block_set[i];
    const size_t row = set != 0 ? begin[kPlaceOfSet.place[set]] : taking_part;
    begin[kPlaceOfSet.place[set]] += set != 0 ? 1 : 0;
    s_.order[row] = static_cast<uint32_t>(i);
    s_.row_of[i] = set != 0 ? static_cast<uint32_t>(row) : 0;
  }
  s_.order.resize(taking_part);
  const size_t groups = padded_entries(taking_part) / kGroup;
  s_.group_set.assign(groups, 0);
  for (size_t row = 0; row < taking_part; ++row) s_.group_set[row / kGroup] |= s_.block_set[s_.order[row]];
}

/// Takes the semantic rows of the tile from wherever they lie.
void SemanticVisit::pack_tile_rows() {
  const size_t padded = pass_.step.padded, depth = padded_depth(padded), count = s_.order.size();
  // A tile that no splat reaches multiplies nothing, yet forms the addresses of its operands.
  const size_t rows = std::max(padded_entries(count), kGroup);
  s_.rounded.resize(count);
  for (size_t r = 0; r < count; ++r) {
    const uint32_t gaussian = tile_.rows[s_.order[r]];
    s_.rounded[r] = pass_.rounded + size_t(gaussian) * depth;
    rows_.prefetch(gaussian);
  }
  s_.tile_plain.resize(rows * depth);
  s_.tile_pairs.resize(rows * padded);
  pack_rows(s_.rounded.data(), count, padded, s_.tile_plain.data(), s_.tile_pairs.data());
  s_.weights_by_entry.resize(rows * kTilePixels);
  s_.weights_by_pixel.resize(rows * kBlockPixels);
  s_.weights_of_row.resize(rows);
  s_.gradient_pairs.resize(kTilePixels * padded);
  s_.directions.resize(kBlockPixels * depth);
  s_.direction_pairs.resize(kBlockPixels * depth);
  while (s_.depth_steps.size() < depth / kTileDepth) {
    s_.depth_steps.push_back(static_cast<uint32_t>(s_.depth_steps.size()));
  }
}

const float* SemanticVisit::visit_block(int index) {
  s_.block.soft = s_.block.hard = 0;
  if (!has_teacher_[index]) return nullptr;
  const BlockWeights& block = tile_.blocks[index];
  return pass_.rounded != nullptr ? visit_tiles(block, index) : visit_float(block, index);
}

const float* SemanticVisit::coupling_direction() const {
  return is_balanced(pass_.step.losses->coupling) ? s_.block.direction.data() : s_.block.blended.data();
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

/// Packs the block's weights and lists the groups of 32 rows that have some.
void SemanticVisit::pack_block_weights(const BlockWeights& block, int index) {
  std::fill(s_.weights_of_row.begin(), s_.weights_of_row.end(), kNoWeights);
  for (size_t e = 0; e < block.count; ++e) {
    s_.weights_of_row[s_.row_of[block.entry[e]]] = block.weight.data() + e * kBlockPixels;
  }
  s_.block_groups.clear();
  for (size_t group = 0; group < s_.group_set.size(); ++group) {
    if (((s_.group_set[group] >> index) & 1u) == 0) continue;
    s_.block_groups.push_back(static_cast<uint32_t>(group));
    pack_weights(s_.weights_of_row.data() + group * kGroup, kTilePixels,
                 s_.weights_by_entry.data() + group * kGroup * kTilePixels + size_t(index) * kBlockPixels,
                 s_.weights_by_pixel.data() + group * kGroup * kBlockPixels);
  }
}

/// Blended rows of pixels [first, first + 32), as P = W^T S.
void SemanticVisit::blend_pixels(size_t first, float* out) const {
  const size_t padded = pass_.step.padded;
  TileProduct p;
  p.a = s_.weights_by_pixel.data() + first * kTileDepth;
  p.a_row = kTileDepth;
  p.a_step = kTileDepth * kBlockPixels;
  p.b = s_.tile_pairs.data();
  p.b_step = kTileDepth * padded;
  p.steps = s_.block_groups.data();
  p.step_count = s_.block_groups.size();
  p.columns = padded;
  p.c = out;
  p.c_row = padded;
  tile_product(p);
}

const float* SemanticVisit::visit_tiles(const BlockWeights& block, int index) {
  const size_t padded = pass_.step.padded, depth = padded_depth(padded);
  uint16_t* pairs = s_.gradient_pairs.data() + size_t(index) * kBlockPixels * padded;
  pack_block_weights(block, index);
  if (begin_half_blocks(pass_.step, block, s_.block)) {
    for (size_t first = 0; first < kBlockPixels; first += kHalfBlockPixels) {
      blend_pixels(first, s_.block.blended.data());
      half_block_loss(pass_.step, block, first, s_.block,
                      {pairs + first * padded, s_.directions.data() + first * depth, depth});
    }
  } else {
    for (size_t first = 0; first < kBlockPixels; first += kHalfBlockPixels) {
      blend_pixels(first, s_.block.blended.data() + first * padded);
    }
    semantic_block_loss(pass_.step, block, s_.block);
    pack_pixels(s_.block.blended.data(), padded, pairs);
    if (pass_.step.couple) round_pixels(coupling_direction(), padded, s_.directions.data());
  }
  if (block.count == 0 || !pass_.step.couple) return nullptr;

  TileProduct coupling;  // Q = S H^T - h_0
  pack_pixels_transposed(s_.directions.data(), depth, s_.direction_pairs.data());
  AlignedArray<float>& q = s_.q[index];
  q.resize(s_.weights_of_row.size() * kBlockPixels);
  for (float& offset : s_.block.offset) offset = -offset;
  coupling.a_row = depth;
  coupling.a_step = kTileDepth;
  coupling.b = s_.direction_pairs.data();
  coupling.b_step = kTileDepth * kBlockPixels;
  coupling.steps = s_.depth_steps.data();
  coupling.step_count = depth / kTileDepth;
  coupling.columns = kBlockPixels;
  coupling.initial = s_.block.offset;
  coupling.c_row = kBlockPixels;
  for (const uint32_t group : s_.block_groups) {
    coupling.a = s_.tile_plain.data() + group * kGroup * depth;
    coupling.c = q.data() + group * kGroup * kBlockPixels;
    tile_product(coupling);
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
  p.columns = padded;
  p.c = out;
  p.c_row = stride;
  tile_product(p);
}

void SemanticVisit::finish() {
  if (pass_.rounded == nullptr || s_.order.empty()) return;
  const size_t padded = pass_.step.padded, count = s_.order.size();
  s_.group_sums.resize(kGroup * padded);
  for (size_t first = 0; first < count; first += kGroup) {
    float* rows[kGroup];
    const size_t n = std::min(kGroup, count - first);
    for (size_t i = 0; i < n; ++i) {
      rows[i] = rows_.sums_of(tile_.rows[s_.order[first + i]]);
      prefetch_row(rows[i], padded);  // from the second-level cache, while the product runs
    }
    row_gradients_of_group(first, s_.group_sums.data(), padded);
    for (size_t i = 0; i < n; ++i) add_row(s_.group_sums.data() + i * padded, padded, rows[i]);
  }
}

}  // namespace aligngs::cpu
