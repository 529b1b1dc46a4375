#include "engine/cpu/row_batches.h"

#include <cstring>

#include "engine/cpu/semantic_rows.h"

namespace aligngs::cpu {

float* TileRows::add(uint32_t target) {
  targets_[count_] = target;
  float* row = rows_ + count_ * padded_;
  std::memset(row, 0, padded_ * sizeof(float));
  ++count_;
  return row;
}

float* TileRows::add_block(size_t count, uint32_t*& targets) {
  targets = targets_ + count_;
  float* rows = rows_ + count_ * padded_;
  count_ += count;
  return rows;
}

void RowBatches::run(const TileLists& lists, size_t padded, size_t targets, ThreadPool& pool, const Visit& visit,
                     float* destination, std::vector<uint8_t>& written) {
  const size_t tiles = lists.tile_begin.size() - 1;
  const size_t limit = kEntriesPerThread * static_cast<size_t>(pool.size());
  const size_t partitions = 4 * static_cast<size_t>(pool.size());
  for (size_t first = 0; first < tiles;) {
    size_t last = first, entries = 0;
    begin_.clear();
    while (last < tiles) {
      const size_t here = static_cast<size_t>(lists.tile_begin[last + 1] - lists.tile_begin[last]);
      if (last > first && entries + here > limit) break;
      begin_.push_back(entries);
      entries += here;
      ++last;
    }
    arena_.resize(std::max(arena_.size(), entries * padded));
    arena_targets_.resize(std::max(arena_targets_.size(), entries));
    count_.assign(last - first, 0);
    pool.parallel_for(last - first, 1, [&](size_t begin, size_t end, int worker) {
      for (size_t t = begin; t < end; ++t) {
        TileRows rows(arena_.data() + begin_[t] * padded, arena_targets_.data() + begin_[t], padded);
        visit(first + t, worker, rows);
        count_[t] = rows.count();
      }
    });
    pool.parallel_for(partitions, 1, [&](size_t begin, size_t end, int) {
      for (size_t partition = begin; partition < end; ++partition) {
        const uint64_t low = partition * uint64_t(targets) / partitions;
        const uint64_t high = (partition + 1) * uint64_t(targets) / partitions;
        for (size_t t = 0; t < last - first; ++t) {
          const uint32_t* target = arena_targets_.data() + begin_[t];
          for (size_t r = 0; r < count_[t]; ++r) {
            if (target[r] < low || target[r] >= high) continue;
            const float* row = arena_.data() + (begin_[t] + r) * padded;
            float* to = destination + size_t(target[r]) * padded;
            if (written[target[r]] != 0) {
              add_row(row, padded, to);
            } else {
              std::memcpy(to, row, padded * sizeof(float));
              written[target[r]] = 1;
            }
          }
        }
      }
    });
    first = last;
  }
}

}  // namespace aligngs::cpu
