// Gaussians that go with a removed object: photos saw their places in its shade, or not at all.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/fill_room.h"

namespace aligngs {

/// A flag per Gaussian. Debris are Gaussians of walls, floor and ceiling under the object, in its shade, with its colour,
/// or hidden by it from all photos. So are hidden Gaussians of things that have no such colour elsewhere, and what the
/// selection leaves of the object itself.
std::vector<uint8_t> find_debris(const FillRoom& r);

}  // namespace aligngs
