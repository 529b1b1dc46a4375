#include "engine/cpu/binning.h"

#include <array>
#include <cstring>

namespace aligngs::cpu {
namespace {

/// Chunks of the depth order that count and emit independently; fixed, so that no result depends on the threads.
constexpr size_t kChunks = 16;
constexpr int kRadixBits = 11, kRadixPasses = 3;  // 33 bits: the whole float in three passes

/// Bits of a positive float order like the number itself.
uint32_t depth_key(float z) {
  uint32_t bits;
  std::memcpy(&bits, &z, sizeof bits);
  return bits;
}

/// Stable least-significant-digit radix sort of lists.visible by lists.keys.
void sort_by_depth(TileLists& lists) {
  constexpr uint32_t kBuckets = 1u << kRadixBits;
  const size_t n = lists.visible.size();
  lists.keys_scratch.resize(n);
  lists.rows_scratch.resize(n);
  std::array<std::array<uint32_t, kBuckets>, kRadixPasses> counts{};
  for (const uint32_t key : lists.keys) {
    for (int pass = 0; pass < kRadixPasses; ++pass) ++counts[pass][(key >> (pass * kRadixBits)) & (kBuckets - 1)];
  }
  for (int pass = 0; pass < kRadixPasses; ++pass) {
    std::array<uint32_t, kBuckets>& count = counts[pass];
    const int shift = pass * kRadixBits;
    if (n > 0 && count[(lists.keys[0] >> shift) & (kBuckets - 1)] == n) continue;  // all alike: already in order
    uint32_t sum = 0;
    for (uint32_t& c : count) {
      const uint32_t here = c;
      c = sum;
      sum += here;
    }
    for (size_t i = 0; i < n; ++i) {
      const uint32_t to = count[(lists.keys[i] >> shift) & (kBuckets - 1)]++;
      lists.keys_scratch[to] = lists.keys[i];
      lists.rows_scratch[to] = lists.visible[i];
    }
    lists.keys.swap(lists.keys_scratch);
    lists.visible.swap(lists.rows_scratch);
  }
}

template <class Body>
void for_each_tile(const TileRect& rect, int tiles_x, const Body& body) {
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) body(size_t(y) * tiles_x + x);
  }
}

}  // namespace

void build_tile_lists(ProjectedView& view, ThreadPool& pool, TileLists& lists) {
  const size_t n = view.size(), tiles = view.tiles();
  lists.slot_begin.resize(n + 1);
  lists.rank.resize(n);
  lists.visible.clear();
  lists.keys.clear();
  uint64_t slots = 0;
  for (size_t i = 0; i < n; ++i) {
    lists.slot_begin[i] = slots;
    lists.rank[i] = static_cast<uint32_t>(lists.visible.size());
    const TileRect& rect = view.rects[i];
    const uint32_t area = rect.area();
    if (area == 0) continue;
    Splat& splat = view.splats[i];
    splat.slot_stride = static_cast<uint32_t>(rect.x1 - rect.x0);
    splat.slot_origin = static_cast<int64_t>(slots) - int64_t(rect.y0) * splat.slot_stride - rect.x0;
    slots += area;
    lists.visible.push_back(static_cast<uint32_t>(i));
    lists.keys.push_back(depth_key(splat.z));
  }
  lists.slot_begin[n] = slots;
  sort_by_depth(lists);

  // cursors[chunk][tile]: first how many instances, then where they go.
  const size_t visible = lists.visible.size(), per_chunk = (visible + kChunks - 1) / kChunks;
  lists.cursors.assign(kChunks * tiles, 0);
  const auto chunk_range = [&](size_t chunk) {
    return std::pair<size_t, size_t>(std::min(visible, chunk * per_chunk), std::min(visible, (chunk + 1) * per_chunk));
  };
  pool.parallel_for(kChunks, 1, [&](size_t first, size_t last, int) {
    for (size_t chunk = first; chunk < last; ++chunk) {
      uint64_t* count = &lists.cursors[chunk * tiles];
      const auto [begin, end] = chunk_range(chunk);
      for (size_t i = begin; i < end; ++i) {
        for_each_tile(view.rects[lists.visible[i]], view.tiles_x, [&](size_t tile) { ++count[tile]; });
      }
    }
  });
  lists.tile_begin.resize(tiles + 1);
  uint64_t position = 0;
  for (size_t tile = 0; tile < tiles; ++tile) {
    lists.tile_begin[tile] = position;
    for (size_t chunk = 0; chunk < kChunks; ++chunk) {
      uint64_t& cursor = lists.cursors[chunk * tiles + tile];
      const uint64_t count = cursor;
      cursor = position;
      position += count;
    }
  }
  lists.tile_begin[tiles] = position;
  lists.gaussians.resize(static_cast<size_t>(position));
  pool.parallel_for(kChunks, 1, [&](size_t first, size_t last, int) {
    for (size_t chunk = first; chunk < last; ++chunk) {
      uint64_t* cursor = &lists.cursors[chunk * tiles];
      const auto [begin, end] = chunk_range(chunk);
      for (size_t i = begin; i < end; ++i) {
        const uint32_t row = lists.visible[i];
        for_each_tile(view.rects[row], view.tiles_x, [&](size_t tile) { lists.gaussians[cursor[tile]++] = row; });
      }
    }
  });
}

}  // namespace aligngs::cpu
