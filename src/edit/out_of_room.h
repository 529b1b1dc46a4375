// Whether an object that was moved or put somewhere reaches into a wall, below the floor, or out of the room.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edit/placement_warnings.h"

namespace aligngs {

/// A sentence about an object that an edit puts at least 5 cm beyond a wall, the floor, the ceiling or the room. Empty
/// where it stays inside. How far it reached before counts as its place there. `selected` marks the rows that move or go.
std::string out_of_room(const EditableRoom& room, const std::vector<uint8_t>& selected, const Placement& placement);

}  // namespace aligngs
