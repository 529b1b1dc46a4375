// The scale of a room from a length that the user knows.
#pragma once

#include <string>

#include "room/measured_room.h"

namespace aligngs {

enum class KnownSide { kWidth, kHeight, kDepth, kLength };

/// The measured length of a side of what has that name: "door.1", "door" where there is only one, "wall.2" (length and
/// height), "ceiling" (height), "sofa.1". Error{kUsage}, with the existing names, for a name that is unknown or that
/// several things have, and for a missing side.
double measured_side(const MeasuredRoom& room, const std::string& name, KnownSide side);

/// The room with lengths such that `measured` becomes `metres`. Error{kUsage} unless both are positive and finite, and
/// the scale changes by less than a factor of a million.
MeasuredRoom scaled_to(const MeasuredRoom& room, double measured, double metres);

/// scaled_to() the distance of two places of the scene, as in scene.ply.
MeasuredRoom scaled_between(const MeasuredRoom& room, const Vec3d& from, const Vec3d& to, double metres);

}  // namespace aligngs
