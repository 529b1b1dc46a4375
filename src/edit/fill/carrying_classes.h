// Classes whose surfaces go on behind and under other things.
#pragma once

#include <vector>

#include "refine/scene_planes.h"
#include "scene/label_set.h"

namespace aligngs {

/// Things that a class carries, and how its surface continues.
struct CarryingClass {
  PlaneKind shell = PlaneKind::kNone;  ///< wall, floor or ceiling: it ends only where the room ends
  bool on_floor = false;               ///< a rug: it continues within its own rectangle on the floor
  bool furniture = false;              ///< things rest or lean on it: it continues within its own bounds
  bool carries() const { return shell != PlaneKind::kNone || on_floor || furniture; }
};

/// For each class of a label set, by name. All other classes (books, vases, cushions, lamps) carry nothing: a surface
/// is never continued with their colours.
std::vector<CarryingClass> carrying_classes(const LabelSet& labels);

}  // namespace aligngs
