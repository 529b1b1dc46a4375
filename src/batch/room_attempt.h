// One attempt at one room, from its lease to its record.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "batch/batch_folder.h"
#include "batch/lease.h"
#include "batch/room_process.h"
#include "batch/room_record.h"

namespace aligngs {

struct AttemptOptions {
  std::filesystem::path program;            ///< own_program()
  std::vector<std::string> global_options;  ///< of every room, as "--offline"
  int threads = 0;                          ///< of a room; 0: all
  uint64_t memory_bytes = 0;                ///< that it may take; 0: the program decides
};

/// The words of the command for a room: `aligngs run` or `aligngs demo`, resumed where a run with the same inputs is
/// there, else from its start.
std::vector<std::string> room_command(const BatchFolder& folder, const Batch& batch, const RoomEntry& room, bool resume,
                                      const AttemptOptions& options);

class RoomAttempt {
 public:
  /// Starts the room's process. `record` is that of an earlier attempt, if there is one.
  RoomAttempt(const BatchFolder& folder, const Batch& batch, const RoomEntry& room, Lease lease,
              const std::optional<RoomRecord>& record, const InputDigest& inputs, const AttemptOptions& options);

  const RoomEntry& room() const { return room_; }
  uint64_t memory_bytes() const { return memory_bytes_; }
  bool ended() { return process_.ended(); }
  void ask_to_stop() const { process_.ask_to_stop(); }
  /// Whether somebody else has the room now: the attempt must be dropped without a record, which ends its process.
  bool lost() const { return lease_.lost(); }
  /// After ended(): whether SIGKILL ended it, by the system for its memory, or together with this worker.
  bool killed() const;
  /// After ended(): writes and returns the record. `interrupted`: this worker was asked to stop, and so was the
  /// process.
  RoomRecord settle(bool interrupted);

 private:
  const BatchFolder& folder_;
  RoomEntry room_;
  Lease lease_;
  RoomRecord record_;
  uint64_t memory_bytes_ = 0;
  RoomProcess process_;
};

}  // namespace aligngs
