// A room with objects taken out, everything else as it was.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "synth/room_model.h"

namespace aligngs {

/// Objects of a room that are taken out together.
struct Removal {
  std::string name;             ///< of the folder of its truth: "chest_of_drawers#1+vase#1"
  std::vector<size_t> objects;  ///< indices into RoomModel::objects, ascending
};

/// "bed#1": the class and a number within it, in the order of RoomModel::objects.
std::string object_name(const RoomModel& room, size_t object);

/// "chest of drawers#1, vase#1"; a class name alone means all its objects. Error{kUsage} for what the room has not,
/// naming what it has, and for walls, floor and ceiling, which carry the rest.
Removal parse_removal(const RoomModel& room, std::string_view text);

/// Without the triangles of those objects, and without the lights inside of their boxes.
RoomModel room_without(const RoomModel& room, const Removal& removal);

/// Corners of the box around an object, in the coordinates of the room's positions.
struct AxisAlignedBox {
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
};
AxisAlignedBox box_of(const RoomModel& room, size_t object);

}  // namespace aligngs
