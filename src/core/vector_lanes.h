// Eight numbers side by side, as vector types of GCC and Clang. Functions with ALIGNGS_TARGET_CLONES get the widest
// registers of the processor for them. Each operation is that of eight scalars: contraction is off.
#pragma once

#include <cstring>

#include "core/always_inline.h"

namespace aligngs {

inline constexpr int kLanes = 8;

/// In registers only: the alignment of these types differs between the versions of a function, so memory has Lanes.
typedef float FloatLanes __attribute__((vector_size(kLanes * sizeof(float))));
typedef double DoubleLanes __attribute__((vector_size(kLanes * sizeof(double))));

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
