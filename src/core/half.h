// IEEE 754 half precision and bfloat16, converted in software (round to nearest even).
#pragma once

#include <cstdint>
#include <cstring>

namespace aligngs {

/// Without branches, so that loops over it become vectors.
inline float half_to_float(uint16_t h) {
  constexpr uint32_t kRebias = 112u << 23;       // exponents are biased by 15 there and by 127 here
  constexpr uint32_t kLeastNormal = 113u << 23;  // 2^-14
  const uint32_t magnitude = h & 0x7fffu, shifted = magnitude << 13, sign = uint32_t(h & 0x8000u) << 16;
  // A subnormal mantissa counts in steps of 2^-24: as the mantissa of 2^-14 it lies that much above 2^-14.
  const uint32_t above_bits = kLeastNormal | shifted;
  float above, least;
  std::memcpy(&above, &above_bits, 4);
  std::memcpy(&least, &kLeastNormal, 4);
  const float subnormal = above - least;
  uint32_t subnormal_bits;
  std::memcpy(&subnormal_bits, &subnormal, 4);
  const uint32_t normal_bits = shifted + kRebias + (magnitude >= 0x7c00u ? kRebias : 0u);  // or infinity, or NaN
  const uint32_t bits = sign | (magnitude < 0x400u ? subnormal_bits : normal_bits);
  float f;
  std::memcpy(&f, &bits, 4);
  return f;
}

inline uint16_t float_to_half(float f) {
  uint32_t bits;
  std::memcpy(&bits, &f, 4);
  const uint32_t sign = (bits >> 16) & 0x8000u, magnitude = bits & 0x7fffffffu;
  if (magnitude > 0x7f800000u) return uint16_t(sign | 0x7e00u);   // NaN
  if (magnitude >= 0x477ff000u) return uint16_t(sign | 0x7c00u);  // rounds to infinity
  if (magnitude < 0x33000001u) return uint16_t(sign);             // rounds to zero
  if (magnitude < 0x38800000u) {                                  // subnormal half
    const int shift = 126 - int(magnitude >> 23);
    const uint32_t m = (magnitude & 0x7fffffu) | 0x800000u;
    const uint32_t rounded =
        (m >> shift) + ((m >> (shift - 1)) & 1u & (((m & ((1u << (shift - 1)) - 1)) != 0) | (m >> shift)));
    return uint16_t(sign | rounded);
  }
  const uint32_t rounded = magnitude + 0xfffu + ((magnitude >> 13) & 1u);
  return uint16_t(sign | ((rounded - 0x38000000u) >> 13));
}

inline float bfloat16_to_float(uint16_t b) {
  const uint32_t bits = uint32_t(b) << 16;
  float f;
  std::memcpy(&f, &bits, 4);
  return f;
}

inline uint16_t float_to_bfloat16(float f) {
  uint32_t bits;
  std::memcpy(&bits, &f, 4);
  if ((bits & 0x7fffffffu) > 0x7f800000u) return uint16_t((bits >> 16) | 0x40u);
  return uint16_t((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}

}  // namespace aligngs
