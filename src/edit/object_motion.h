// How an object moves.
#pragma once

#include <string>

#include "core/vec.h"

namespace aligngs {

/// A motion as a person sees it who is at the mean place of the photos' cameras and looks at the objects.
struct ObjectMotion {
  Vec3d shift;  ///< scene units: to the right, upwards, towards that person
  /// degrees, counter-clockwise seen from above, about the upright axis through the middle of the box
  double turn = 0;
  // For sentences, until settled_motion.h knows the room:
  bool in_metres = false;  ///< so are `shift` and `distance`: the sentence has a unit
  std::string toward{};    ///< a selection: the motion is toward it
  double distance = 0;     ///< toward it; negative: away
  /// It may turn there.
  bool stays_in_place() const { return shift.x == 0 && shift.y == 0 && shift.z == 0 && toward.empty(); }
  bool is_still() const { return stays_in_place() && turn == 0; }
};

}  // namespace aligngs
