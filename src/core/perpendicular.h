// A direction at right angles to another.
#pragma once

#include <cmath>

#include "core/vec.h"

namespace aligngs {

/// A unit vector perpendicular to the unit vector n, the same for the same n.
inline Vec3d perpendicular_to(const Vec3d& n) {
  return normalized(cross(std::fabs(n.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, n));
}

}  // namespace aligngs
