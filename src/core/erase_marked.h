// Removes the marked items of a list; the others keep their order.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace aligngs {

/// `marked` has a flag per item. Returns how many were removed.
template <class Item>
size_t erase_marked(std::vector<Item>& items, const std::vector<bool>& marked) {
  size_t kept = 0;
  for (size_t i = 0; i < items.size(); ++i) {
    if (!marked[i] && kept++ != i) items[kept - 1] = std::move(items[i]);
  }
  const size_t erased = items.size() - kept;
  items.erase(items.begin() + static_cast<std::ptrdiff_t>(kept), items.end());
  return erased;
}

}  // namespace aligngs
