// The shade that removed objects leave on the surfaces that stay: how much brighter each Gaussian is without them.
#pragma once

#include <vector>

#include "core/vec.h"
#include "edit/fill/fill_room.h"

namespace aligngs {

/// A factor for each colour channel of each row; 1 where nothing changes. Empty where nothing changes at all.
///
/// A surface that is out of reach of a removed object tells the light near it. A smooth continuation of that light is
/// compared with the mean colour that the surface has there. Shade is lifted; light is never taken away.
std::vector<Vec3f> lifted_shade(const FillRoom& r);

/// A constant harmonic whose colour is `gain` times brighter.
Vec3f lifted(const Vec3f& harmonic, const Vec3f& gain);

}  // namespace aligngs
