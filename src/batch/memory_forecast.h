// How much memory a room will take, told from its photos before anything is read: the local queue starts no more rooms
// than fit.
#pragma once

#include <cstdint>

#include "batch/batch_folder.h"

namespace aligngs {

/// Bytes: the value of --memory, else what the plan of the room's run (pipeline/run_plan.h) expects. A network of photos
/// that is not installed here may be installed where the room is worked on, and counts as the largest one.
uint64_t predicted_room_bytes(const BatchFolder& folder, const Batch& batch, const RoomEntry& room);

/// Limit of a room beside others: its part of `budget`, or its prediction where that is more; never more than `budget`.
uint64_t memory_share(uint64_t predicted, uint64_t budget, int jobs);

}  // namespace aligngs
