// The pixels at which a step compares patches (patch_score.h), alike on every engine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/formulas/index_hash.h"

namespace aligngs {

/// Patches of one step: the published 102400 of a view of 640 x 480, and the same share of a smaller one.
inline constexpr double kPatchesMax = 102400;
inline constexpr double kPatchShare = kPatchesMax / (640.0 * 480.0);

/// The share of `agreeing` > 0 pixels, in an image of `pixels`, that makes the number above expected; above 1: all of
/// them.
ALIGNGS_HD inline double patch_share(double agreeing, double pixels) {
  const double patches = kPatchShare * pixels;
  return (patches < kPatchesMax ? patches : kPatchesMax) / agreeing;
}

/// True for `share` of all pixels in the mean; the same for the same seed and pixel on every machine.
ALIGNGS_HD inline bool draws_patch(uint64_t seed, size_t pixel, double share) {
  return static_cast<double>(index_hash(seed, pixel) >> 11) * 0x1p-53 < share;
}

}  // namespace aligngs
