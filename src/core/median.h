// The middle of a list.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace aligngs {

/// The upper one of two middle values; 0 for an empty list. Values must be comparable (no NaN).
template <class T>
T median_of(std::vector<T> values) {
  if (values.empty()) return T(0);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace aligngs
