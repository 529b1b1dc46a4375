// Adds rows of C numbers that tiles produce for Gaussians, in tile order, on any number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/aligned_array.h"
#include "engine/cpu/binning.h"

namespace aligngs::cpu {

/// The rows of one tile, in an arena shared by a batch of tiles.
class TileRows {
 public:
  TileRows(float* rows, uint32_t* targets, size_t padded) : rows_(rows), targets_(targets), padded_(padded) {}
  /// A new row of zeros whose sum belongs to `target`.
  float* add(uint32_t target);
  /// `count` new rows, one behind the other, of any value; their targets are to be filled in.
  float* add_block(size_t count, uint32_t*& targets);
  size_t count() const { return count_; }

 private:
  float* rows_;
  uint32_t* targets_;
  size_t padded_, count_ = 0;
};

/// Tiles fill rows in parallel, batch by batch; after each batch the rows are added to their targets, each target by
/// one thread in tile order. So a target's sum has one order whatever the threads and the batches are.
class RowBatches {
 public:
  /// Entries of the tiles of one batch, per thread: at 160 channels 5 MB, of which a thread's cache holds a good part,
  /// and some 30 tiles, enough to keep the threads evenly busy.
  static constexpr size_t kEntriesPerThread = 8192;

  using Visit = std::function<void(size_t tile, int worker, TileRows& rows)>;

  /// Calls visit for every tile. It may add at most as many rows as the tile has entries in `lists`.
  /// destination[target] receives the sum where written[target] becomes 1; other rows are left as they are.
  void run(const TileLists& lists, size_t padded, size_t targets, ThreadPool& pool, const Visit& visit,
           float* destination, std::vector<uint8_t>& written);

  uint64_t bytes() const { return arena_.capacity_bytes() + arena_targets_.capacity_bytes(); }

 private:
  AlignedArray<float> arena_;
  AlignedArray<uint32_t> arena_targets_;
  std::vector<size_t> begin_, count_;
};

}  // namespace aligngs::cpu
