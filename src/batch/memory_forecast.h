// How much memory a room will take, told from its photos before anything is read: the local queue starts no more rooms
// than fit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "batch/batch_folder.h"

namespace aligngs {

/// Bytes. The value of --memory comes first. Else the peak of an earlier run of the room counts, with a tenth more.
/// Else it is an
/// estimate from the number and the size of the photos.
uint64_t predicted_room_bytes(const BatchFolder& folder, const Batch& batch, const RoomEntry& room);

/// The estimate for so many pixels of training photos together.
uint64_t estimated_bytes(uint64_t pixels);

/// Limit of a room beside others: its part of `budget`, or its prediction where that is more; never more than `budget`.
uint64_t memory_share(uint64_t predicted, uint64_t budget, int jobs);

}  // namespace aligngs
