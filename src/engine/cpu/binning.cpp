#include "engine/cpu/binning.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace aligngs::cpu {
namespace {

constexpr size_t kMostChunks = 16;
constexpr int kRadixBits = 11, kRadixPasses = 3;  // 33 bits: the whole float in three passes
constexpr uint32_t kBuckets = 1u << kRadixBits;
// Counts of the chunks lie that far apart: at a power of two, the same bucket of all chunks would share few cache lines.
constexpr size_t kBucketStride = kBuckets + 16;

/// Chunks of the rows, and of the depth order, that count and emit independently. No result depends on how many there
/// are: slots are numbered row by row, and the sorts are stable. Sums over all chunks have one thread, so few are better.
size_t chunk_count(const ThreadPool& pool) {
  return std::min(kMostChunks, size_t(2) * static_cast<size_t>(pool.size()));
}

struct ChunkRange {
  size_t begin, end;
};

template <class Body>
void for_each_chunk(ThreadPool& pool, size_t count, const Body& body) {
  const size_t chunks = chunk_count(pool), length = (count + chunks - 1) / chunks;
  pool.parallel_for(chunks, 1, [&](size_t first, size_t last, int) {
    for (size_t chunk = first; chunk < last; ++chunk) {
      body(chunk, ChunkRange{std::min(count, chunk * length), std::min(count, (chunk + 1) * length)});
    }
  });
}

/// Bits of a positive float order like the number itself.
uint32_t depth_key(float z) {
  uint32_t bits;
  std::memcpy(&bits, &z, sizeof bits);
  return bits;
}

/// Numbers the slots, and lists the visible rows with their depths.
void list_visible(ProjectedView& view, ThreadPool& pool, TileLists& lists) {
  const size_t n = view.size(), chunks = chunk_count(pool);
  lists.slot_begin.resize(n + 1);
  lists.rank.resize(n);
  lists.chunk_visible.assign(chunks, 0);
  lists.chunk_slots.assign(chunks, 0);
  for_each_chunk(pool, n, [&](size_t chunk, ChunkRange range) {
    uint64_t visible = 0, slots = 0;
    for (size_t i = range.begin; i < range.end; ++i) {
      const uint32_t area = view.rects[i].area();
      visible += area > 0 ? 1 : 0;
      slots += area;
    }
    lists.chunk_visible[chunk] = visible;
    lists.chunk_slots[chunk] = slots;
  });
  uint64_t visible = 0, slots = 0;
  for (size_t chunk = 0; chunk < chunks; ++chunk) {  // from counts to where each chunk begins
    visible += std::exchange(lists.chunk_visible[chunk], visible);
    slots += std::exchange(lists.chunk_slots[chunk], slots);
  }
  lists.visible.resize(static_cast<size_t>(visible));
  lists.keys.resize(static_cast<size_t>(visible));
  lists.slot_begin[n] = slots;
  for_each_chunk(pool, n, [&](size_t chunk, ChunkRange range) {
    size_t at = static_cast<size_t>(lists.chunk_visible[chunk]);
    uint64_t slot = lists.chunk_slots[chunk];
    for (size_t i = range.begin; i < range.end; ++i) {
      lists.slot_begin[i] = slot;
      lists.rank[i] = static_cast<uint32_t>(at);
      const TileRect& rect = view.rects[i];
      const uint32_t area = rect.area();
      if (area == 0) continue;
      Splat& splat = view.splats[i];
      splat.slot_stride = static_cast<uint32_t>(rect.x1 - rect.x0);
      splat.slot_origin = static_cast<int64_t>(slot) - int64_t(rect.y0) * splat.slot_stride - rect.x0;
      slot += area;
      lists.visible[at] = static_cast<uint32_t>(i);
      lists.keys[at++] = depth_key(splat.z);
    }
  });
}

/// Stable least-significant-digit radix sort of lists.visible by lists.keys.
void sort_by_depth(ThreadPool& pool, TileLists& lists) {
  const size_t n = lists.visible.size(), chunks = chunk_count(pool);
  lists.keys_scratch.resize(n);
  lists.rows_scratch.resize(n);
  for (int pass = 0; pass < kRadixPasses; ++pass) {
    const auto digit = [shift = pass * kRadixBits](uint32_t key) { return (key >> shift) & (kBuckets - 1); };
    lists.digit_counts.assign(chunks * kBucketStride, 0);
    for_each_chunk(pool, n, [&](size_t chunk, ChunkRange range) {
      uint32_t* count = &lists.digit_counts[chunk * kBucketStride];
      for (size_t i = range.begin; i < range.end; ++i) ++count[digit(lists.keys[i])];
    });
    uint32_t sum = 0;
    bool alike = false;  // all keys have the same digit: already in order
    for (uint32_t bucket = 0; bucket < kBuckets; ++bucket) {
      const uint32_t before = sum;
      for (size_t chunk = 0; chunk < chunks; ++chunk) {
        sum += std::exchange(lists.digit_counts[chunk * kBucketStride + bucket], sum);
      }
      alike |= sum - before == n;
    }
    if (alike) continue;
    for_each_chunk(pool, n, [&](size_t chunk, ChunkRange range) {
      uint32_t* next = &lists.digit_counts[chunk * kBucketStride];
      for (size_t i = range.begin; i < range.end; ++i) {
        const uint32_t to = next[digit(lists.keys[i])]++;
        lists.keys_scratch[to] = lists.keys[i];
        lists.rows_scratch[to] = lists.visible[i];
      }
    });
    lists.keys.swap(lists.keys_scratch);
    lists.visible.swap(lists.rows_scratch);
  }
}

template <class Body>
void for_each_tile(const TileRect& rect, int tiles_x, const Body& body) {
  // One loop, not two: how it ends cannot be foreseen, and most rectangles are one or two tiles wide.
  const uint32_t width = static_cast<uint32_t>(rect.x1 - rect.x0), area = rect.area();
  const size_t step = static_cast<size_t>(tiles_x) - width;
  size_t tile = size_t(rect.y0) * tiles_x + rect.x0;
  for (uint32_t i = 0, x = 0; i < area; ++i) {
    body(tile);
    const bool last = ++x == width;
    tile += last ? step + 1 : 1;
    x = last ? 0 : x;
  }
}

}  // namespace

void build_tile_lists(ProjectedView& view, ThreadPool& pool, TileLists& lists) {
  const size_t tiles = view.tiles(), chunks = chunk_count(pool);
  list_visible(view, pool, lists);
  sort_by_depth(pool, lists);

  // cursors[chunk][tile]: first how many instances, then where they go.
  const size_t visible = lists.visible.size();
  lists.cursors.assign(chunks * tiles, 0);
  for_each_chunk(pool, visible, [&](size_t chunk, ChunkRange range) {
    uint64_t* count = &lists.cursors[chunk * tiles];
    for (size_t i = range.begin; i < range.end; ++i) {
      for_each_tile(view.rects[lists.visible[i]], view.tiles_x, [&](size_t tile) { ++count[tile]; });
    }
  });
  lists.tile_begin.resize(tiles + 1);
  uint64_t position = 0;
  for (size_t tile = 0; tile < tiles; ++tile) {
    lists.tile_begin[tile] = position;
    for (size_t chunk = 0; chunk < chunks; ++chunk) {
      uint64_t& cursor = lists.cursors[chunk * tiles + tile];
      const uint64_t count = cursor;
      cursor = position;
      position += count;
    }
  }
  lists.tile_begin[tiles] = position;
  lists.gaussians.resize(static_cast<size_t>(position));
  for_each_chunk(pool, visible, [&](size_t chunk, ChunkRange range) {
    uint64_t* cursor = &lists.cursors[chunk * tiles];
    for (size_t i = range.begin; i < range.end; ++i) {
      const uint32_t row = lists.visible[i];
      for_each_tile(view.rects[row], view.tiles_x, [&](size_t tile) { lists.gaussians[cursor[tile]++] = row; });
    }
  });
}

}  // namespace aligngs::cpu
