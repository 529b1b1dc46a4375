// One list behind another.
#pragma once

#include <vector>

namespace aligngs {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// As append(), without spare room behind: for a large list that seldom grows, whose spare room is memory lost.
template <class T>
void append_exactly(std::vector<T>& to, const std::vector<T>& from) {
  to.reserve(to.size() + from.size());
  append(to, from);
}

}  // namespace aligngs
