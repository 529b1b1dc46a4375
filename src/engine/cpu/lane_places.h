// The set bits of a byte as numbers: what a vector of eight lanes keeps when a mask compresses it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace aligngs::cpu {

inline constexpr size_t kByteBits = 8;

/// Numbers of the set bits of `byte` at [8 byte, 8 byte + count), lowest first; then zeros.
constexpr std::array<uint8_t, 256 * kByteBits> places_of_bits() {
  std::array<uint8_t, 256 * kByteBits> places{};
  for (size_t byte = 0; byte < 256; ++byte) {
    size_t count = 0;
    for (size_t bit = 0; bit < kByteBits; ++bit) {
      if ((byte >> bit & 1u) != 0) places[kByteBits * byte + count++] = static_cast<uint8_t>(bit);
    }
  }
  return places;
}

alignas(64) inline constexpr std::array<uint8_t, 256 * kByteBits> kPlacesOfBits = places_of_bits();

}  // namespace aligngs::cpu
