#include "batch/batch_status.h"

#include <fmt/format.h>

#include <optional>

#include "batch/option_words.h"
#include "core/error.h"
#include "train/run_folder.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

RoomStatus status_of(const BatchFolder& folder, const Batch& batch, const RoomEntry& room, const LeaseTimes& times) {
  RoomStatus status;
  status.room = room;
  const LeaseView lease = look_at_lease(folder.leases(), room.name, times);
  const std::optional<RoomRecord> record = read_room_record(folder.record(room.name));
  if (record) status.record = *record;
  if (lease.held()) {
    status.state = RoomState::kRunning;
    status.worker = lease.host.empty() ? "" : fmt::format("{}, process {}", lease.host, lease.pid);
  } else {
    status.state = settled_state(folder, room, record, digest_inputs(batch, room, status.record.inputs));
  }
  const RunFolder run(folder.run(room.name));
  if (run.has_run()) {
    const RunRecord course = read_run_record(run.record());
    status.stage = word_of(course.stage);
    status.iterations = course.train.iterations;
  }
  return status;
}

}  // namespace

std::vector<RoomStatus> batch_status(const BatchFolder& folder, const Batch& batch, const LeaseTimes& times) {
  std::vector<RoomStatus> all;
  for (const RoomEntry& room : batch.rooms) all.push_back(status_of(folder, batch, room, times));
  return all;
}

std::string retry_command(const BatchFolder& folder, const std::string& room) {
  return "aligngs batch retry " + quote_word(folder.path().string()) + " " + quote_word(room);
}

bool forget_failure(const BatchFolder& folder, const std::string& room, bool from_start, const LeaseTimes& times) {
  const std::optional<Lease> lease = Lease::take(folder.leases(), room, times);
  if (!lease) throw_usage("a worker has the room " + room, "wait until it ends, or stop it");
  std::optional<RoomRecord> record = read_room_record(folder.record(room));
  if (from_start) {
    std::error_code error;
    fs::remove(folder.record(room), error);
    if (error) throw_resources(folder.record(room), "cannot be removed: " + error.message());
    return true;
  }
  if (!record || record->state != AttemptState::kFailed) return false;
  record->state = AttemptState::kStopped;
  write_room_record(folder.record(room), *record);
  return true;
}

}  // namespace aligngs
