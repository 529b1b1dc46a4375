// Sums over the taps of a patch, for several shifts of it side by side. src/refine internal: use refine/patch.h.
#pragma once

#include <cstring>

#include "core/vector_lanes.h"
#include "refine/patch.h"

namespace aligngs {

/// The four pixels around a tap, at every shift.
struct TapCorners {
  FloatLanes upper_left, upper_right, lower_left, lower_right;
};

/// The sums so far.
struct TapSums {
  DoubleLanes dot{}, sum{}, squares{};
};

ALIGNGS_ALWAYS_INLINE void add_tap(const ShiftedScores::Tap& tap, const TapCorners& c, TapSums& to) {
  const FloatLanes top = (1 - tap.right) * c.upper_left + tap.right * c.upper_right,
                   bottom = (1 - tap.right) * c.lower_left + tap.right * c.lower_right;
  const FloatLanes mixed = (1 - tap.down) * top + tap.down * bottom;
  const DoubleLanes luma = doubles_of(mixed);
  to.dot += static_cast<double>(tap.value) * luma;
  to.sum += luma;
  to.squares += luma * luma;
}

ALIGNGS_ALWAYS_INLINE void store(const TapSums& from, ShiftedScores::Sums& to) {
  std::memcpy(to.dot, &from.dot, sizeof(from.dot));
  std::memcpy(to.sum, &from.sum, sizeof(from.sum));
  std::memcpy(to.squares, &from.squares, sizeof(from.squares));
}

}  // namespace aligngs
