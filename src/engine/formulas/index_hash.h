// Draws that every engine makes alike, in any order and on any thread: a hash of a seed and an index.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/vec.h"

namespace aligngs {

/// 64 evenly spread bits; the finaliser of SplitMix64 (Steele et al. 2014) over seed and index.
ALIGNGS_HD inline uint64_t index_hash(uint64_t seed, size_t index) {
  uint64_t z = seed + (static_cast<uint64_t>(index) + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

}  // namespace aligngs
