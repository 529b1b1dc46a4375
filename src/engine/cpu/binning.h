// The Gaussians that each tile blends, front to back.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/splats.h"

namespace aligngs::cpu {

/// An instance is a (Gaussian, tile) pair. Instances are numbered twice. By Gaussian, its slots are contiguous, in the
/// row-major order of its rectangle; gradients are left there for reduction. By tile, they are in depth order.
struct TileLists {
  std::vector<uint64_t> slot_begin;  ///< [N + 1] first slot of each Gaussian
  std::vector<uint64_t> tile_begin;  ///< [tiles + 1] first entry of each tile in `gaussians`
  AlignedArray<uint32_t> gaussians;  ///< rows of the model, by tile, by depth, ties by row
  std::vector<uint32_t> visible;     ///< rows with a tile, in depth order
  std::vector<uint32_t> rank;        ///< [N] number of visible rows below this one: a dense index in row order
  size_t instances() const { return slot_begin.empty() ? 0 : static_cast<size_t>(slot_begin.back()); }

  // Scratch of build_tile_lists.
  std::vector<uint32_t> keys, keys_scratch, rows_scratch, digit_counts;
  std::vector<uint64_t> cursors, chunk_visible, chunk_slots;
};

/// Depth order by a stable radix sort of the depths, then a counting sort by tile, both over fixed chunks. The result
/// does not depend on the number of threads. Offsets are 64-bit. Writes the slots into the view's splats.
void build_tile_lists(ProjectedView& view, ThreadPool& pool, TileLists& lists);

}  // namespace aligngs::cpu
