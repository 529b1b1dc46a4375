// The description of a room from photos with depth, where nothing has a label: walls, floor and ceiling.
#pragma once

#include "room/find_room.h"
#include "room/room_structure.h"

namespace aligngs {

/// Settings of find_room() for labels that planes gave: depth is measured, and no teacher's outlines are wrong.
RoomSettings settings_of_unlabelled_rooms();

struct UnlabelledRoomSettings {
  RoomStructureSettings structure;
  RoomSettings room = settings_of_unlabelled_rooms();
};

/// As find_room(), of inputs whose `up` is known, at least roughly; labels and objects are not used. Pixels that no
/// surface covers (certainty 0) have no depth. Error{kBadInput} where no plane is a wall, and errors as find_room's.
MeasuredRoom find_unlabelled_room(const RoomInputs& inputs, const UnlabelledRoomSettings& settings, ThreadPool& pool);

}  // namespace aligngs
