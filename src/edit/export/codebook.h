// Vector quantisation for compressed files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/thread_pool.h"

namespace aligngs {

/// 256 levels for scalar values (Lloyd 1982, from equal shares of the sorted values), ascending.
std::vector<float> scalar_codebook(const std::vector<float>& values);
/// Index of the level nearest to a value.
uint8_t nearest_level(const std::vector<float>& codebook, float value);

struct Palette {
  size_t width = 0;             ///< values per entry
  std::vector<float> entries;   ///< [count][width]
  std::vector<uint16_t> index;  ///< per row: its entry
  size_t count() const { return width ? entries.size() / width : 0; }
};
/// k-means (Lloyd) with `count` entries started from evenly spaced rows; the same for any number of threads.
Palette make_palette(const std::vector<float>& rows, size_t width, size_t count, int rounds, ThreadPool& pool);

}  // namespace aligngs
