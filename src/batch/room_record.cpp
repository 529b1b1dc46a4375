#include "batch/room_record.h"

#include <nlohmann/json.hpp>

#include "batch/option_words.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_integer.h"
#include "io/json_text.h"
#include "train/run_folder.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kRecordSchema = 1;
constexpr uint64_t kLargestRecord = 1 << 20;  // bytes; a record has some lines

std::string text_of(const Json& json, const char* name) {
  const auto it = json.find(name);
  return it != json.end() && it->is_string() ? it->get<std::string>() : std::string();
}

}  // namespace

void write_room_record(const fs::path& path, const RoomRecord& r) {
  const Json json = {{"schema", kRecordSchema},    {"state", word_of(r.state)},
                     {"digest", r.inputs.content}, {"quick_digest", r.inputs.quick},
                     {"command", r.command},       {"host", r.host},
                     {"attempts", r.attempts},     {"exit_status", r.exit_status},
                     {"message", r.message},       {"path", r.path},
                     {"field", r.field},           {"remedy", r.remedy},
                     {"started", r.started},       {"ended", r.ended}};
  write_file_atomically(path, json_document(json));
}

std::optional<RoomRecord> read_room_record(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  const Json json = parse_ordered_json(read_file(path, kLargestRecord));
  if (!json.is_object()) return std::nullopt;
  RoomRecord r;
  r.state = choice_named<AttemptState>(text_of(json, "state")).value_or(AttemptState::kRunning);
  r.inputs = {text_of(json, "digest"), text_of(json, "quick_digest")};
  r.command = text_of(json, "command");
  r.host = text_of(json, "host");
  r.attempts = integer_member<int>(json, "attempts");
  r.exit_status = integer_member<int>(json, "exit_status");
  r.message = text_of(json, "message");
  r.path = text_of(json, "path");
  r.field = text_of(json, "field");
  r.remedy = text_of(json, "remedy");
  r.started = text_of(json, "started");
  r.ended = text_of(json, "ended");
  if (r.inputs.content.empty()) return std::nullopt;
  return r;
}

const char* name_of(RoomState state) {
  switch (state) {
    case RoomState::kStopped:
      return "stopped";
    case RoomState::kChanged:
      return "changed";
    case RoomState::kRunning:
      return "running";
    case RoomState::kDone:
      return "done";
    case RoomState::kFailed:
      return "failed";
    default:
      return "waiting";
  }
}

bool run_is_done(const fs::path& run) {
  const fs::path file = RunFolder(run).record();
  if (!is_run_record(file)) return false;
  const RunRecord record = read_run_record(file);
  return record.status == RunStatus::kDone && record.stage == RunStage::kDone;
}

RoomState settled_state(const BatchFolder& folder, const RoomEntry& room, const std::optional<RoomRecord>& record,
                        const InputDigest& inputs) {
  if (!record) return RoomState::kWaiting;
  if (record->inputs.content != inputs.content) return RoomState::kChanged;
  if (record->state == AttemptState::kFailed) return RoomState::kFailed;
  // A worker that died before it wrote the record leaves kRunning. A run with a check is then measured again.
  const bool settled = record->state == AttemptState::kDone || !has_option(room.options, "--fail-under");
  if (settled && run_is_done(folder.run(room.name))) return RoomState::kDone;
  return RunFolder(folder.run(room.name)).has_run() ? RoomState::kStopped : RoomState::kWaiting;
}

}  // namespace aligngs
