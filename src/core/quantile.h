// The value below which a share of a list lies.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace aligngs {

/// `share` in [0, 1]; 0 for an empty list. Values must be comparable (no NaN).
template <class T>
T quantile_of(std::vector<T> values, double share) {
  if (values.empty()) return T(0);
  const size_t k = std::min(values.size() - 1, static_cast<size_t>(share * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(k);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace aligngs
