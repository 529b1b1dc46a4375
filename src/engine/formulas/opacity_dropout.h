// Opacity dropout: a step leaves some Gaussians out and makes the others as much more opaque. No Gaussian can then hide
// behind another that only its own photo needs (DropGaussian, Park et al., CVPR 2025). Alike on every engine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/formulas/index_hash.h"

namespace aligngs {

/// The dropout of one step; a rate of 0 changes nothing.
struct OpacityDropout {
  float rate = 0;     ///< share of the Gaussians that are left out, [0, kDropoutRateMax]
  uint64_t seed = 0;  ///< draws them

  /// Factor on the opacity of those that stay: the expected opacity remains what it was.
  ALIGNGS_HD float factor() const { return 1.0f / (1.0f - rate); }
  /// True for `rate` of all rows in the mean; the same for the same seed and row on every machine.
  ALIGNGS_HD bool drops(size_t row) const {
    if (rate <= 0) return false;
    return static_cast<float>(index_hash(seed, row) >> 40) * 0x1p-24f < rate;  // 24 bits are what a float holds
  }
};

/// Beyond this the few that stay would all be opaque.
inline constexpr float kDropoutRateMax = 0.9f;

}  // namespace aligngs
