// Values below which a share of a list lies, by three rules that differ by up to a rank.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace aligngs {

namespace quantile_detail {

template <class T>
T at_rank(std::vector<T>& values, size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace quantile_detail

/// `share` in [0, 1]; 0 for an empty list. Values must be comparable (no NaN).
template <class T>
T quantile_of(std::vector<T> values, double share) {
  if (values.empty()) return T(0);
  const auto rank = static_cast<size_t>(share * static_cast<double>(values.size()));
  return quantile_detail::at_rank(values, std::min(values.size() - 1, rank));
}

/// The value at `share` of the way from the first rank to the last one, at the nearest rank; 0 for an empty list.
template <class T>
T nearest_rank_of(std::vector<T> values, double share) {
  if (values.empty()) return T(0);
  return quantile_detail::at_rank(values, static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5));
}

/// The same at the rank below.
template <class T>
T lower_rank_of(std::vector<T> values, double share) {
  if (values.empty()) return T(0);
  return quantile_detail::at_rank(values, static_cast<size_t>(share * static_cast<double>(values.size() - 1)));
}

}  // namespace aligngs
