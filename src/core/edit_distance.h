// How many letters differ between two words: for "did you mean".
#pragma once

#include <cstddef>
#include <string_view>

namespace aligngs {

/// Least number of insertions, deletions and replacements of one byte that turn `a` into `b` (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace aligngs
