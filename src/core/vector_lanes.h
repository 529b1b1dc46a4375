// Eight numbers side by side, as vector types of GCC and Clang. Functions with ALIGNGS_TARGET_CLONES get the widest
// registers of the processor for them. Each operation is that of eight scalars: contraction is off.
#pragma once

#include <cstring>

#include "core/always_inline.h"

namespace aligngs {

inline constexpr int kLanes = 8;

/// In registers only: the alignment of these types differs between the versions of a function, so memory has Lanes.
typedef float FloatLanes __attribute__((vector_size(kLanes * sizeof(float))));
/// Four doubles and four more: GCC keeps vectors that are wider than the registers in memory, which takes three times as
/// long with AVX2.
struct DoubleLanes {
  typedef double Half __attribute__((vector_size(kLanes / 2 * sizeof(double))));
  Half low, high;

  ALIGNGS_ALWAYS_INLINE double operator[](int lane) const {
    return lane < kLanes / 2 ? low[lane] : high[lane - kLanes / 2];
  }
  ALIGNGS_ALWAYS_INLINE DoubleLanes& operator+=(const DoubleLanes& b) {
    low += b.low;
    high += b.high;
    return *this;
  }
  ALIGNGS_ALWAYS_INLINE DoubleLanes& operator*=(const DoubleLanes& b) {
    low *= b.low;
    high *= b.high;
    return *this;
  }
};
ALIGNGS_ALWAYS_INLINE DoubleLanes operator+(const DoubleLanes& a, const DoubleLanes& b) {
  return {a.low + b.low, a.high + b.high};
}
ALIGNGS_ALWAYS_INLINE DoubleLanes operator-(const DoubleLanes& a) { return {-a.low, -a.high}; }
ALIGNGS_ALWAYS_INLINE DoubleLanes operator*(const DoubleLanes& a, const DoubleLanes& b) {
  return {a.low * b.low, a.high * b.high};
}
ALIGNGS_ALWAYS_INLINE DoubleLanes operator*(double a, const DoubleLanes& b) { return {a * b.low, a * b.high}; }
ALIGNGS_ALWAYS_INLINE DoubleLanes operator*(const DoubleLanes& a, double b) { return {a.low * b, a.high * b}; }

ALIGNGS_ALWAYS_INLINE DoubleLanes doubles_of(const FloatLanes& floats) {
  typedef float Half __attribute__((vector_size(kLanes / 2 * sizeof(float))));
  const Half low = __builtin_shufflevector(floats, floats, 0, 1, 2, 3),
             high = __builtin_shufflevector(floats, floats, 4, 5, 6, 7);
  return {__builtin_convertvector(low, DoubleLanes::Half), __builtin_convertvector(high, DoubleLanes::Half)};
}

/// In memory.
struct Lanes {
  double value[kLanes]{};

  double& operator[](int lane) { return value[lane]; }
  double operator[](int lane) const { return value[lane]; }
};

ALIGNGS_ALWAYS_INLINE void load(const Lanes& from, DoubleLanes& to) { std::memcpy(&to, from.value, sizeof(to)); }
ALIGNGS_ALWAYS_INLINE void store(const DoubleLanes& from, Lanes& to) { std::memcpy(to.value, &from, sizeof(from)); }
ALIGNGS_ALWAYS_INLINE void add(const DoubleLanes& what, Lanes& to) {
  DoubleLanes sum;
  load(to, sum);
  sum += what;
  store(sum, to);
}

}  // namespace aligngs
