// A worker: takes rooms that nobody has, starts them, and waits for them. Any number of workers share a folder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "batch/batch_folder.h"
#include "batch/lease.h"
#include "batch/room_attempt.h"

namespace aligngs {

struct WorkerOptions {
  AttemptOptions attempt;     ///< of every room; memory_bytes is the worker's to set
  int jobs = 1;               ///< rooms at a time
  uint64_t memory_bytes = 0;  ///< of all rooms at a time; 0: no limit but that of each room
  LeaseTimes times;
};

/// Names of rooms, by how they are when the worker ends.
struct WorkerSummary {
  std::vector<std::string> done, failed;
  std::vector<std::string> stopped;    ///< begun or not, and left behind by a signal
  std::vector<std::string> elsewhere;  ///< with another worker that is alive
  bool interrupted = false;            ///< a signal asked this worker to stop

  size_t rooms() const { return done.size() + failed.size() + stopped.size() + elsewhere.size(); }
};

/// Works until no room of `rooms` is left, or until a signal asks to stop: its rooms then write their checkpoints
/// first. A failed room does not end the work. Rooms of another worker are left to it where its lease is seen to be
/// renewed, and taken over where it is not.
WorkerSummary work_on(const BatchFolder& folder, const Batch& batch, const std::vector<RoomEntry>& rooms,
                      const WorkerOptions& options);

}  // namespace aligngs
