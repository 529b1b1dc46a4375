// The exact description of a synthetic room, as room.json has it.
#pragma once

#include "room/measured_room.h"
#include "synth/room_model.h"

namespace aligngs {

/// Walls, openings, pictures and furniture of a room, wherever it is in its world. Pictures are things that hang flat
/// on a wall. Boxes enclose all of an object, in the turn of its smallest footprint.
MeasuredRoom room_truth(const RoomModel& room);

}  // namespace aligngs
