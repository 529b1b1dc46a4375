// The furniture that carried a removed object, or that it leaned on, continues within its own bounds.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/fill_room.h"

namespace aligngs {

/// At most two holes: in the plane under a part of the removed objects, and in the one behind it. Legs are no plate, and
/// stay apart. A place that photos looked through stays open.
std::vector<SurfaceHole> furniture_holes(const FillRoom& r, const std::vector<uint8_t>& part);

}  // namespace aligngs
