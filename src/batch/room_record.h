// How the last attempt at a room ended, and the state that follows from it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "batch/batch_folder.h"
#include "batch/input_digest.h"
#include "core/choice_words.h"

namespace aligngs {

/// The end of an attempt, as its record states it.
enum class AttemptState {
  kRunning,  ///< also of a worker that died
  kDone,
  kStopped,
  kFailed
};
template <>
inline constexpr std::array<ChoiceWord<AttemptState>, 4> kChoiceWords<AttemptState> = {
    {{AttemptState::kRunning, "running"},
     {AttemptState::kDone, "done"},
     {AttemptState::kStopped, "stopped"},
     {AttemptState::kFailed, "failed"}}};

struct RoomRecord {
  AttemptState state = AttemptState::kRunning;
  InputDigest inputs;                        ///< of the attempt
  std::string command;                       ///< that was started
  std::string host;                          ///< where
  int attempts = 0;                          ///< starts with these inputs
  int exit_status = 0;                       ///< of a failed one; 128 + signal where a signal ended it
  std::string message, path, field, remedy;  ///< of a failed one, as Error has them
  std::string started, ended;                ///< UTC, ISO 8601
};

/// Atomic.
void write_room_record(const std::filesystem::path& path, const RoomRecord& record);
/// Nothing where there is no record, or one that is damaged: the room then begins anew.
std::optional<RoomRecord> read_room_record(const std::filesystem::path& path);

enum class RoomState {
  kWaiting,  ///< nothing was done, or its worker died before anything was written
  kStopped,  ///< begun; goes on from its checkpoint
  kChanged,  ///< begun or done with other inputs: begins anew
  kRunning,  ///< a worker has it
  kDone,     ///< run.json says that the run is done, and the inputs are those of the run
  kFailed    ///< goes on after `aligngs batch retry` or with other inputs
};
const char* name_of(RoomState state);  ///< "waiting", ...

/// Whether run.json of a run says that all its stages are done.
bool run_is_done(const std::filesystem::path& run);

/// The state apart from leases; never kRunning. `inputs` are those of now.
RoomState settled_state(const BatchFolder& folder, const RoomEntry& room, const std::optional<RoomRecord>& record,
                        const InputDigest& inputs);

}  // namespace aligngs
