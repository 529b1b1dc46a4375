// The one rule about which values of a depth map count.
#pragma once

#include <cmath>

namespace aligngs {

/// True for a depth that was measured: finite and in front of the camera. Zero, negative, infinite and NaN values mean
/// "no depth" in every map.
template <class Real>
bool is_depth(Real z) {
  return std::isfinite(z) && z > 0;
}

}  // namespace aligngs
