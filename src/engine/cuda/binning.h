// The Gaussians that each tile blends, front to back: rows sorted by depth, their (Gaussian, tile) pairs sorted by
// tile. Both sorts are stable, so pairs of a tile are in depth order and equal depths in row order.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/view_spans.h"

namespace aligngs::cuda {

/// Counts that the host reads back to plan the memory of later steps.
struct BinCounts {
  unsigned long long instances;  ///< pairs of this view, whether they fitted or not
  uint32_t unculled;             ///< rows with a rectangle
  uint32_t overflow;             ///< 1: more pairs than room, all rows were culled
};

/// counts.instances and counts.unculled of a projected view.
void count_tile_pairs(const DeviceContext& context, const ViewSpans& view, DeviceSpan<BinCounts> counts);

/// Fills `lists`, whose sizes are N + 1, tiles + 1, the room for pairs, and N; places beyond the pairs are undefined.
/// Writes the slots into the splats. If the pairs do not fit, every row is culled, counts.overflow is set and `bad` [1]
/// is lowered to 0. The step then writes nothing and can be repeated with more room. Nothing waits for the host. At
/// most 2^32 - 1 pairs. Scratch comes from the arena.
void build_tile_lists(DeviceArena& arena, const ViewSpans& view, const TileListSpans& lists,
                      DeviceSpan<BinCounts> counts, DeviceSpan<unsigned long long> bad);

}  // namespace aligngs::cuda
