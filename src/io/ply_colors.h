// Colours of the vertices of a PLY, as programs write them.
#pragma once

#include <vector>

#include "core/vec.h"
#include "io/ply.h"

namespace aligngs {

/// Colours in [0, 1] from the properties red, green, blue or r, g, b: integers of 8 or 16 bits, or floats. NaN counts as
/// 0. Empty where there are none.
std::vector<Vec3f> ply_colors(const PlyElement& vertices);

}  // namespace aligngs
