// The rows of a list that a mask keeps.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace aligngs {

/// The rows of `width` values for which `keep` is not 0, in their order, in a list without spare room. `values` holds
/// keep.size() rows.
template <class T>
std::vector<T> kept_rows(const std::vector<T>& values, const std::vector<uint8_t>& keep, size_t width) {
  std::vector<T> out;
  out.reserve(width * static_cast<size_t>(std::count_if(keep.begin(), keep.end(), [](uint8_t k) { return k != 0; })));
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i])
      out.insert(out.end(), values.begin() + static_cast<std::ptrdiff_t>(i * width),
                 values.begin() + static_cast<std::ptrdiff_t>((i + 1) * width));
  }
  return out;
}

}  // namespace aligngs
