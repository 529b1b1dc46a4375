// How every room of a batch is, from the files of its folder alone.
#pragma once

#include <string>
#include <vector>

#include "batch/batch_folder.h"
#include "batch/lease.h"
#include "batch/room_record.h"

namespace aligngs {

struct RoomStatus {
  RoomEntry room;
  RoomState state = RoomState::kWaiting;
  RoomRecord record;       ///< of the last attempt; empty before the first
  std::string stage;       ///< of run.json: "train", "mesh", ...; empty without a run
  int64_t iterations = 0;  ///< of the training, completed
  std::string worker;      ///< "host, process 123" of a running room
};

/// In the order of the list. Reads the files of a source again only where their sizes or times differ from those of the
/// last attempt.
std::vector<RoomStatus> batch_status(const BatchFolder& folder, const Batch& batch, const LeaseTimes& times);

/// The command that makes a failed room go on.
std::string retry_command(const BatchFolder& folder, const std::string& room);

/// Forgets that a room failed; it goes on, or from its start with `from_start`. False where it did not fail and
/// `from_start` is off.
/// Error{kUsage} while a worker has it.
bool forget_failure(const BatchFolder& folder, const std::string& room, bool from_start, const LeaseTimes& times);

}  // namespace aligngs
