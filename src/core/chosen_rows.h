// The rows of a list that a list of numbers chooses.
#pragma once

#include <cstdint>
#include <vector>

namespace aligngs {

/// `values` of `rows`, in their order, in a list without spare room. Each row is smaller than values.size().
template <class T>
std::vector<T> chosen_rows(const std::vector<T>& values, const std::vector<uint32_t>& rows) {
  std::vector<T> out;
  out.reserve(rows.size());
  for (const uint32_t row : rows) out.push_back(values[row]);
  return out;
}

}  // namespace aligngs
