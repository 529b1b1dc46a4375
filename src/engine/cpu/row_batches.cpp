#include "engine/cpu/row_batches.h"

#include <algorithm>
#include <cstring>

#include "engine/cpu/adam.h"
#include "engine/cpu/semantic_rows.h"

namespace aligngs::cpu {
namespace {

/// Groups beyond this many list entries wait for the next batch, so that memory stays bounded however many Gaussians
/// cover the whole image. At most this many rows are kept at a time, usually a tenth of it.
constexpr uint64_t kEntriesPerBatch = uint64_t(1) << 20;
constexpr int kGroupSizeMax = 4;  ///< tiles: the sums of 16 tiles, some 2000 rows of 640 bytes, fit a cache of 2 MB
constexpr int kGroupsWanted = 64;

constexpr size_t kRectsAhead = 16;  ///< they lie anywhere in memory
constexpr size_t kRowsAhead = 2;

struct Grid {
  int size, columns, rows;
  Grid(int tiles_x, int tiles_y, int group)
      : size(group), columns((tiles_x + group - 1) / group), rows((tiles_y + group - 1) / group) {}
  size_t count() const { return size_t(columns) * rows; }
  TileRect rect(size_t group, const ProjectedView& view) const {
    const int x = static_cast<int>(group % columns) * size, y = static_cast<int>(group / columns) * size;
    return {static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<uint16_t>(std::min(x + size, view.tiles_x)),
            static_cast<uint16_t>(std::min(y + size, view.tiles_y))};
  }
};

}  // namespace

void GroupSums::reset() {
  if (count > 0) rows.fill(0.0f);
  count = 0;
}

TileRows::TileRows(GroupSums& sums, size_t padded, size_t entries) : sums_(sums), padded_(padded) {
  const size_t most = sums.count + entries, zeroed = sums.rows.size();
  if (most * padded > zeroed) {
    sums.rows.resize(most * padded);
    std::memset(sums.rows.data() + zeroed, 0, (most * padded - zeroed) * sizeof(float));
  }
  if (most + 1 > sums.gaussians.size()) sums.gaussians.resize(most + 1);
}

float* TileRows::sums_of(uint32_t gaussian) {
  const uint32_t count = static_cast<uint32_t>(sums_.count), at = sums_.index[gaussian];
  const bool known = (at < count) & (sums_.gaussians[std::min(at, count)] == gaussian);
  const uint32_t place = known ? at : count;
  sums_.index[gaussian] = place;
  sums_.gaussians[place] = gaussian;
  sums_.count += known ? 0 : 1;
  return sums_.rows.data() + size_t(place) * padded_;
}

int RowBatches::group_size(int tiles_x, int tiles_y) {
  int size = kGroupSizeMax;
  while (size > 1 && Grid(tiles_x, tiles_y, size).count() < kGroupsWanted) size /= 2;
  return size;
}

uint64_t RowBatches::bytes() const {
  uint64_t bytes = 0;
  for (const SharedRows& s : shared_) bytes += s.rows.capacity_bytes() + s.targets.capacity() * sizeof(uint32_t);
  for (const GroupSums& s : own_) {
    bytes += s.rows.capacity_bytes() + (s.gaussians.capacity() + s.index.capacity()) * sizeof(uint32_t);
  }
  return bytes;
}

bool RowBatches::run(const ProjectedView& view, const TileLists& lists, const RowSumTarget& sums, ThreadPool& pool,
                     const Visit& visit) {
  const Grid grid(view.tiles_x, view.tiles_y, group_size(view.tiles_x, view.tiles_y));
  const auto entries_of = [&](size_t tile) {
    return static_cast<size_t>(lists.tile_begin[tile + 1] - lists.tile_begin[tile]);
  };
  const auto group_entries = [&](size_t group) {
    const TileRect r = grid.rect(group, view);
    uint64_t n = 0;
    for (size_t y = r.y0; y < r.y1; ++y) {
      n += lists.tile_begin[y * view.tiles_x + r.x1] - lists.tile_begin[y * view.tiles_x + r.x0];
    }
    return n;
  };
  own_.resize(static_cast<size_t>(pool.size()));
  for (GroupSums& own : own_) own.index.resize(std::max(own.index.size(), view.size()));
  std::vector<uint8_t> harmless(grid.count(), 0);
  for (size_t first = 0; first < grid.count();) {
    size_t last = first;
    for (uint64_t entries = 0; last < grid.count(); ++last) {
      entries += group_entries(last);
      if (last > first && entries > kEntriesPerBatch) break;
    }
    if (shared_.size() < last - first) shared_.resize(last - first);
    pool.parallel_for(last - first, 1, [&](size_t begin, size_t end, int worker) {
      for (size_t g = begin; g < end; ++g) {
        GroupSums& own = own_[static_cast<size_t>(worker)];
        own.reset();
        const TileRect group = grid.rect(first + g, view);
        for (size_t y = group.y0; y < group.y1; ++y) {
          for (size_t tile = y * view.tiles_x + group.x0; tile < y * view.tiles_x + group.x1; ++tile) {
            TileRows rows(own, sums.padded, entries_of(tile));
            visit(tile, worker, rows);
          }
        }
        harmless[first + g] = finish_group(view, group, sums, own, shared_[g]) ? 1 : 0;
      }
    });
    add_shared(sums, last - first, pool);
    first = last;
  }
  return std::all_of(harmless.begin(), harmless.end(), [](uint8_t good) { return good != 0; });
}

bool RowBatches::finish_group(const ProjectedView& view, const TileRect& group, const RowSumTarget& sums,
                              GroupSums& own, SharedRows& shared) {
  const auto inside = [&](const TileRect& r) {
    return r.x0 >= group.x0 && r.y0 >= group.y0 && r.x1 <= group.x1 && r.y1 <= group.y1;
  };
  const size_t padded = sums.padded;
  size_t reaching_out = 0;
  for (size_t i = 0; i < own.count; ++i) {
    if (i + kRectsAhead < own.count) __builtin_prefetch(&view.rects[own.gaussians[i + kRectsAhead]]);
    reaching_out += inside(view.rects[own.gaussians[i]]) ? 0 : 1;
  }
  bool harmless = true;
  shared.targets.clear();
  shared.rows.resize(std::max(shared.rows.size(), reaching_out * padded));
  for (size_t i = 0; i < own.count; ++i) {
    const uint32_t gaussian = own.gaussians[i];
    const uint32_t target = sums.target_of_row != nullptr ? sums.target_of_row[gaussian] : gaussian;
    float* row = own.rows.data() + i * padded;
    prefetch_row(row + kRowsAhead * padded, padded);  // beyond the last one there are rows of zeros, or nothing to lose
    harmless = harmless && all_within(row, padded, kHarmless);
    if (!inside(view.rects[gaussian])) {
      stream_row(row, padded, shared.rows.data() + shared.targets.size() * padded);
      shared.targets.push_back(target);
    } else if ((*sums.written)[target] != 0) {
      add_row(row, padded, sums.destination + size_t(target) * padded);
    } else {
      stream_row(row, padded, sums.destination + size_t(target) * padded);
      (*sums.written)[target] = 1;
    }
    std::memset(row, 0, padded * sizeof(float));
  }
  own.count = 0;
  finish_streams();
  return harmless;
}

void RowBatches::add_shared(const RowSumTarget& sums, size_t groups, ThreadPool& pool) {
  const size_t partitions = 4 * static_cast<size_t>(pool.size()), padded = sums.padded;
  std::vector<uint8_t>& written = *sums.written;
  pool.parallel_for(partitions, 1, [&](size_t begin, size_t end, int) {
    for (size_t partition = begin; partition < end; ++partition) {
      const uint64_t low = partition * uint64_t(sums.targets) / partitions;
      const uint64_t high = (partition + 1) * uint64_t(sums.targets) / partitions;
      for (size_t g = 0; g < groups; ++g) {
        const std::vector<uint32_t>& targets = shared_[g].targets;
        for (size_t r = 0; r < targets.size(); ++r) {
          const uint32_t target = targets[r];
          if (target < low || target >= high) continue;
          const float* row = shared_[g].rows.data() + r * padded;
          float* to = sums.destination + size_t(target) * padded;
          if (written[target] != 0) {
            add_row(row, padded, to);
          } else {
            std::memcpy(to, row, padded * sizeof(float));
            written[target] = 1;
          }
        }
      }
    }
  });
}

}  // namespace aligngs::cpu
