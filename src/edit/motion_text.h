// Motions in words: "sofa by 0.5,0,-0.2", "chair 0.5 m to the left", "lamp by 90 degrees".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "edit/object_motion.h"

namespace aligngs {

/// "0.5,0,-0.2": three numbers, at most 1000 scene units each. Error{kUsage} for anything else.
Vec3d parse_shift(std::string_view text);
/// "90": degrees, -360 to 360. Error{kUsage} for anything else.
double parse_turn(std::string_view text);

/// Takes a motion off the end of `text`: "by X,Y,Z", "by X,Y,Z and turn by DEGREES", or a length and a direction in
/// either order. Examples are "0.5 m to the left", "50cm up", "left by 2 feet". Nothing where the text ends otherwise;
/// Error{kUsage} for numbers out of range, and for a length without a direction.
/// "50 cm towards the window" has a thing instead of a direction (settled_motion.h).
std::optional<ObjectMotion> take_motion(std::string& text);
/// Error{kUsage} where a text without a motion ends in a place: "chair to the window" needs a length, and "20 cm north"
/// has no direction.
void refuse_place(const std::string& text);
/// Error{kUsage} where a copy has a side and no length: "armchair to the left".
void refuse_side(const std::string& text);

/// Error{kUsage} for a motion that leaves everything in its place: no way, and no turn but whole circles.
void require_motion(const ObjectMotion& motion);

/// " by 0.5,0,-0.2 and turn by 90" as take_motion() reads it; empty without motion.
std::string motion_text(const ObjectMotion& motion);

}  // namespace aligngs
