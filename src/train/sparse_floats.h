// Floats most of which are one value, as a bit for each and the bytes of the others. After the photos' vote nineteen
// class scores in twenty are the least one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace aligngs {

struct SparseFloats {
  uint32_t common = 0;  ///< bits of the value that is left out
  std::string bytes;  ///< the bits, least significant first; then each byte of the other values by itself, lowest first
};

/// Nothing where one value, bit for bit, does not fill three quarters. `floats` are little-endian.
std::optional<SparseFloats> sparse_floats(std::string_view floats);

/// Most bytes that SparseFloats::bytes can have for `count` floats.
size_t most_sparse_bytes(size_t count);

/// Undoes sparse_floats(): writes `count` floats. False where the bytes do not fit the count.
bool expand_sparse_floats(uint32_t common, std::string_view bytes, size_t count, uint8_t* floats);

}  // namespace aligngs
