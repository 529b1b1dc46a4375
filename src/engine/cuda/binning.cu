// Kernels of binning.h.
#include "engine/cuda/binning.h"

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"
#include "device/sort_scan.h"

namespace aligngs::cuda {

inline constexpr uint32_t kCulledDepth = 0xffffffffu;  ///< behind every depth

/// `areas` (one more than rows: a scan leaves the sum there) and `unculled` may be empty.
__global__ void __launch_bounds__(kRowThreads)
    count_pairs(DeviceSpan<const TileRect> rects, DeviceSpan<uint32_t> areas, DeviceSpan<uint32_t> unculled,
                DeviceSpan<BinCounts> counts) {
  __shared__ unsigned long long area_sums[32];
  __shared__ uint32_t row_sums[32];
  const size_t i = item_index();
  const uint32_t area = i < rects.size ? rects[i].area() : 0;
  if (i < areas.size) areas[i] = area;
  if (i < unculled.size) unculled[i] = area > 0;
  const unsigned long long pairs = block_sum<unsigned long long>(area, area_sums);
  const uint32_t rows = block_sum<uint32_t>(area > 0, row_sums);
  if (threadIdx.x != 0) return;
  atomicAdd(&counts[0].instances, pairs);
  atomicAdd(&counts[0].unculled, rows);
}

/// Gives every row its slots and its depth, or culls it when the pairs of all rows do not fit.
__global__ void __launch_bounds__(kRowThreads)
    number_slots(ViewSpans view, TileListSpans lists, DeviceSpan<BinCounts> counts, DeviceSpan<uint32_t> depths,
                 DeviceSpan<uint32_t> rows, DeviceSpan<unsigned long long> bad) {
  const size_t i = item_index();
  const bool overflow = counts[0].instances > lists.gaussians.size;
  if (overflow && i == 0) {
    counts[0].overflow = 1;
    atomicMin(&bad[0], 0ull);
  }
  if (overflow && i < lists.slot_begin.size) lists.slot_begin[i] = 0;
  if (i >= view.rects.size) return;
  if (overflow) {
    view.rects[i] = TileRect{};
    lists.rank[i] = 0;
  }
  rows[i] = static_cast<uint32_t>(i);
  depths[i] = kCulledDepth;
  const TileRect rect = view.rects[i];
  if (rect.area() == 0) return;
  Splat& s = view.splats[i];
  s.slot_stride = static_cast<uint32_t>(rect.x1 - rect.x0);
  s.slot_origin = int64_t(lists.slot_begin[i]) - int64_t(rect.y0) * s.slot_stride - rect.x0;
  depths[i] = __float_as_uint(s.z);  // bits of a positive float order like the number
}

__global__ void __launch_bounds__(kRowThreads)
    areas_by_depth(DeviceSpan<const TileRect> rects, DeviceSpan<const uint32_t> order, DeviceSpan<uint32_t> areas) {
  const size_t k = item_index();
  if (k < order.size) areas[k] = rects[order[k]].area();
}

__device__ __forceinline__ uint32_t tile_of(const TileRect& rect, uint32_t index, int tiles_x) {
  const uint32_t width = rect.x1 - rect.x0;
  return (rect.y0 + index / width) * static_cast<uint32_t>(tiles_x) + rect.x0 + index % width;
}

/// Pairs in depth order. A wide rectangle is written by the whole warp, so that no thread keeps 31 others waiting.
__global__ void __launch_bounds__(kRowThreads)
    write_pairs(ViewSpans view, DeviceSpan<const uint32_t> order, DeviceSpan<const uint32_t> begin,
                DeviceSpan<uint32_t> tiles, DeviceSpan<uint32_t> rows) {
  const size_t k = item_index();
  const bool inside = k < order.size;
  const uint32_t row = inside ? order[k] : 0, first = inside ? begin[k] : 0;
  const TileRect rect = inside ? view.rects[row] : TileRect{};
  const uint32_t area = rect.area();
  if (area <= kWideRectangle) {
    for (uint32_t j = 0; j < area; ++j) {
      tiles[first + j] = tile_of(rect, j, view.tiles_x);
      rows[first + j] = row;
    }
  }
  for (unsigned wide = __ballot_sync(kFullWarp, area > kWideRectangle); wide != 0; wide &= wide - 1) {
    const int source = __ffs(static_cast<int>(wide)) - 1;
    const uint32_t their_row = __shfl_sync(kFullWarp, row, source), at = __shfl_sync(kFullWarp, first, source);
    const TileRect theirs = view.rects[their_row];
    const uint32_t theirs_area = theirs.area();
    for (uint32_t j = lane_index(); j < theirs_area; j += 32) {
      tiles[at + j] = tile_of(theirs, j, view.tiles_x);
      rows[at + j] = their_row;
    }
  }
}

/// Room that no pair took sorts behind every tile.
__global__ void __launch_bounds__(kRowThreads) pad_pairs(DeviceSpan<const uint32_t> slot_begin, uint32_t behind,
                                                         DeviceSpan<uint32_t> tiles, DeviceSpan<uint32_t> rows) {
  const size_t i = item_index();
  if (i >= tiles.size || i < slot_begin[slot_begin.size - 1]) return;
  tiles[i] = behind;
  rows[i] = 0;
}

/// The start of each tile: a thread whose key differs from the one before it opens every tile in between.
__global__ void __launch_bounds__(kRowThreads)
    open_tiles(DeviceSpan<const uint32_t> tiles, DeviceSpan<uint32_t> tile_begin) {
  const size_t i = item_index();
  if (i >= tiles.size) return;
  const uint32_t next = i == 0 ? 0 : tiles[i - 1] + 1, last = static_cast<uint32_t>(tile_begin.size - 1);
  for (uint32_t t = next; t <= tiles[i] && t <= last; ++t) tile_begin[t] = static_cast<uint32_t>(i);
  if (i + 1 != tiles.size) return;
  for (uint32_t t = tiles[i] + 1; t <= last; ++t) tile_begin[t] = static_cast<uint32_t>(tiles.size);
}
namespace {

int bits_of(uint32_t value) {
  int bits = 0;
  while (value >> bits != 0) ++bits;
  return bits;
}

}  // namespace

void count_tile_pairs(const DeviceContext& context, const ViewSpans& view, DeviceSpan<BinCounts> counts) {
  fill_zero(context, counts);
  launch(context, "count_pairs", count_pairs, one_per_item(view.rects.size, kRowThreads), view.rects,
         DeviceSpan<uint32_t>{}, DeviceSpan<uint32_t>{}, counts);
}

void build_tile_lists(DeviceArena& arena, const ViewSpans& view, const TileListSpans& lists,
                      DeviceSpan<BinCounts> counts, DeviceSpan<unsigned long long> bad) {
  const DeviceContext& context = arena.context();
  const size_t n = view.rects.size, room = lists.gaussians.size;
  fill_zero(context, counts);
  fill_zero(context, lists.tile_begin);
  launch(context, "count_pairs", count_pairs, one_per_item(n + 1, kRowThreads), view.rects, lists.slot_begin,
         lists.rank, counts);
  exclusive_scan(arena, lists.slot_begin, lists.slot_begin);
  exclusive_scan(arena, lists.rank, lists.rank);
  const auto depths = arena.take<uint32_t>(n, "depths"), sorted_depths = arena.take<uint32_t>(n, "sorted depths");
  const auto rows = arena.take<uint32_t>(n, "rows"), order = arena.take<uint32_t>(n, "rows by depth");
  launch(context, "number_slots", number_slots, one_per_item(n + 1, kRowThreads), view, lists, counts, depths, rows,
         bad);
  if (n == 0 || room == 0) return;
  sort_pairs(arena, depths, rows, sorted_depths, order, 32);
  const DeviceSpan<uint32_t> begin = rows;  // no longer needed
  launch(context, "areas_by_depth", areas_by_depth, one_per_item(n, kRowThreads), view.rects, order, begin);
  exclusive_scan(arena, begin, begin);

  const uint32_t tiles = static_cast<uint32_t>(lists.tile_begin.size - 1);
  const auto pair_tiles = arena.take<uint32_t>(room, "tiles of pairs"),
             sorted_tiles = arena.take<uint32_t>(room, "sorted tiles of pairs"),
             pair_rows = arena.take<uint32_t>(room, "rows of pairs");
  launch(context, "write_pairs", write_pairs, one_per_item(n, kRowThreads), view, order, begin, pair_tiles, pair_rows);
  launch(context, "pad_pairs", pad_pairs, one_per_item(room, kRowThreads), lists.slot_begin, tiles, pair_tiles,
         pair_rows);
  sort_pairs(arena, pair_tiles, pair_rows, sorted_tiles, lists.gaussians, bits_of(tiles));
  launch(context, "open_tiles", open_tiles, one_per_item(room, kRowThreads), sorted_tiles, lists.tile_begin);
}

}  // namespace aligngs::cuda
