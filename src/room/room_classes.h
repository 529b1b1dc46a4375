// Meaning of a label set's classes for the description of a room.
#pragma once

#include <optional>
#include <vector>

#include "room/measured_room.h"
#include "scene/label_set.h"

namespace aligngs {

struct RoomClass {
  bool wall = false, floor = false, ceiling = false;  ///< surfaces of the room itself; a rug is floor
  bool glass = false;                                 ///< its depth says nothing of where it is
  std::optional<OpeningKind> opening;                 ///< it is a rectangle on a wall
  bool furniture = false;                             ///< it is described by a box
  bool leafy = false;                                 ///< it has no closed surface, and its Gaussians tell its size
};

/// For each class of a label set, by name. Classes of none of these kinds (cushions, books, curtains) are left out of
/// the description.
std::vector<RoomClass> room_classes(const LabelSet& labels);

}  // namespace aligngs
