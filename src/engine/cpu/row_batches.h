// Adds rows of C numbers that tiles produce for Gaussians, in one order on any number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/aligned_array.h"
#include "engine/cpu/binning.h"

namespace aligngs::cpu {

/// Rows are added to destination + target * padded, where target is the Gaussian's row or target_of_row of it.
struct RowSumTarget {
  size_t padded = 0;
  const uint32_t* target_of_row = nullptr;  ///< nullptr: the row itself
  size_t targets = 0;
  /// of an AlignedArray; valid where written, other rows are left as they are
  float* destination = nullptr;
  std::vector<uint8_t>* written = nullptr;  ///< [targets]
};

/// Sums of the Gaussians of one group of tiles, in a thread's cache.
struct GroupSums {
  size_t count = 0;
  AlignedArray<float> rows;         ///< [count][padded]; everything behind is zero
  std::vector<uint32_t> gaussians;  ///< [count], and room for one more
  std::vector<uint32_t> index;      ///< [N] any value: valid only if that row confirms it

  void reset();  ///< no Gaussians, whatever happened before
};

/// The rows to which a tile adds. Valid for one tile.
class TileRows {
 public:
  /// Room for `entries` more rows, so that pointers stay valid while the tile is visited.
  TileRows(GroupSums& sums, size_t padded, size_t entries);

  /// The sums of a Gaussian within this group, zeros at first. Without branches: half of the Gaussians of a tile are
  /// new, in no order that a processor could foresee.
  float* sums_of(uint32_t gaussian);
  /// Asks for what sums_of looks up first.
  void prefetch(uint32_t gaussian) const { __builtin_prefetch(&sums_.index[gaussian], 1); }

 private:
  GroupSums& sums_;
  size_t padded_;
};

/// Partial sums of Gaussians that reach beyond their group of tiles.
struct SharedRows {
  AlignedArray<float> rows;       ///< [count][padded]
  std::vector<uint32_t> targets;  ///< [count]
};

/// Groups of neighbouring tiles are visited in parallel, the tiles of one in order by one thread, whose sums stay in
/// its cache meanwhile. Then the sums of a Gaussian that lies within the group go to their destination. Sums of one
/// that reaches further are kept and added after all groups, in the groups' order. So a target's sum has one order
/// whatever the threads are, and most rows leave the cache once.
class RowBatches {
 public:
  using Visit = std::function<void(size_t tile, int worker, TileRows& rows)>;

  /// Calls visit for every tile. It may ask for the rows of Gaussians of that tile's list only. Returns false when some
  /// group's sum was not a number or beyond kHarmless: then the sums over all groups are to be looked at.
  bool run(const ProjectedView& view, const TileLists& lists, const RowSumTarget& sums, ThreadPool& pool,
           const Visit& visit);

  uint64_t bytes() const;

  /// Edge of a group in tiles: 4, less for small images so that the groups keep some sixteen threads busy.
  static int group_size(int tiles_x, int tiles_y);

 private:
  /// Few enough that the sums of a billion groups stay within kGradientLimit (adam.h).
  static constexpr float kHarmless = 1e8f;

  bool finish_group(const ProjectedView& view, const TileRect& group, const RowSumTarget& sums, GroupSums& own,
                    SharedRows& shared);
  void add_shared(const RowSumTarget& sums, size_t groups, ThreadPool& pool);

  std::vector<SharedRows> shared_;  ///< [groups of a batch]
  std::vector<GroupSums> own_;      ///< [thread]
};

}  // namespace aligngs::cpu
