// The main part of an object's points, without the strays of its class elsewhere in the room.
#pragma once

#include <vector>

#include "core/vec.h"

namespace aligngs {

/// The points of the most populous group of cubes of side `cell` that touch each other, by a corner at least. Points
/// that are not finite are left out; none, or a cell that is not positive: empty.
std::vector<Vec3d> largest_cluster(const std::vector<Vec3d>& points, double cell);

}  // namespace aligngs
