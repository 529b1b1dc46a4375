// Whether an object that was moved reaches into a wall, below the floor, or out of the room.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/rigid.h"
#include "edit/apply_edit.h"

namespace aligngs {

/// A sentence about an object that its motion takes at least 5 cm beyond a wall, the floor, the ceiling or the room.
/// Empty where it stays inside. How far it reached before counts as its place there. `selected` marks its rows before
/// the motion.
std::string out_of_room(const EditableRoom& room, const std::vector<uint8_t>& selected, const Similarity& motion);

}  // namespace aligngs
