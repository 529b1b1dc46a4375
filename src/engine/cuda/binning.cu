#include "engine/cuda/binning.h"

#include "device/constants.h"
#include "device/launch.h"
#include "device/sort_scan.h"
#include "engine/cuda/binning.cuh"

namespace aligngs::cuda {
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
