#include "batch/room_attempt.h"

#include <fmt/format.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "batch/option_words.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "train/run_folder.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kLargestOutput = uint64_t(64) << 20;  // bytes: metrics.json of some thousand views
constexpr int kStopped = static_cast<int>(ErrorKind::kInterrupted);

/// Whether a status is that of a process which was asked to stop before it could answer, as in its first milliseconds.
bool was_asked_to_stop(int status) {
  return status == 128 + SIGTERM || status == 128 + SIGINT || status == 128 + SIGHUP || status == 128 + SIGUSR1;
}

/// Writes the record of a beginning attempt before its process starts.
RoomRecord begun(const BatchFolder& folder, const RoomEntry& room, const std::optional<RoomRecord>& before,
                 const InputDigest& inputs, const std::vector<std::string>& words) {
  RoomRecord record;
  record.state = AttemptState::kRunning;
  record.inputs = inputs;
  record.command = join_words(words);
  record.host = host_name();
  record.attempts = before && before->inputs.content == inputs.content ? before->attempts + 1 : 1;
  record.started = utc_now();
  write_room_record(folder.record(room.name), record);
  return record;
}

RoomCommand command_of(const BatchFolder& folder, const Batch& batch, const RoomEntry& room,
                       std::vector<std::string> words) {
  return {std::move(words), batch.base(), folder.output(room.name), folder.log(room.name)};
}

/// Error{...} as `--json` prints it; empty fields where the process could not print it.
void take_error(const fs::path& output, RoomRecord& record) {
  std::error_code error;
  if (!fs::exists(output, error)) return;
  const nlohmann::json document = parse_json(read_file(output, kLargestOutput));
  if (!document.is_object() || !document.contains("error") || !document["error"].is_object()) return;
  const nlohmann::json& details = document["error"];
  const auto text = [&](const char* name) {
    const auto it = details.find(name);
    return it != details.end() && it->is_string() ? it->get<std::string>() : std::string();
  };
  record.message = text("message");
  record.path = text("path");
  record.field = text("field");
  record.remedy = text("remedy");
}

bool may_resume(const BatchFolder& folder, const RoomEntry& room, const std::optional<RoomRecord>& record,
                const InputDigest& inputs) {
  return record && record->inputs.content == inputs.content && RunFolder(folder.run(room.name)).has_run();
}

}  // namespace

std::vector<std::string> room_command(const BatchFolder& folder, const Batch& batch, const RoomEntry& room, bool resume,
                                      const AttemptOptions& options) {
  std::vector<std::string> words = {options.program.string(), room.synthetic() ? "demo" : "run"};
  if (!room.synthetic()) words.push_back(batch.source_of(room).string());
  words.insert(words.end(), {"-o", folder.run(room.name).string(), resume ? "--resume" : "--overwrite", "--json"});
  if (options.threads > 0 && !has_option(room.options, "--threads"))
    words.insert(words.end(), {"--threads", std::to_string(options.threads)});
  if (options.memory_bytes > 0 && !has_option(room.options, "--memory")) {
    words.insert(words.end(), {"--memory", fmt::format("{:.3f}", static_cast<double>(options.memory_bytes) * 1e-9)});
  }
  words.insert(words.end(), options.global_options.begin(), options.global_options.end());
  words.insert(words.end(), room.options.begin(), room.options.end());
  return words;
}

RoomAttempt::RoomAttempt(const BatchFolder& folder, const Batch& batch, const RoomEntry& room, Lease lease,
                         const std::optional<RoomRecord>& record, const InputDigest& inputs,
                         const AttemptOptions& options)
    : folder_(folder),
      room_(room),
      lease_(std::move(lease)),
      record_(begun(folder, room, record, inputs,
                    room_command(folder, batch, room, may_resume(folder, room, record, inputs), options))),
      memory_bytes_(options.memory_bytes),
      process_(command_of(folder, batch, room,
                          room_command(folder, batch, room, may_resume(folder, room, record, inputs), options))) {}

bool RoomAttempt::killed() const { return process_.status() == 128 + SIGKILL; }

RoomRecord RoomAttempt::settle(bool interrupted) {
  const int status = process_.status();
  record_.ended = utc_now();
  record_.exit_status = status;
  if (status == 0 && run_is_done(folder_.run(room_.name))) {
    record_.state = AttemptState::kDone;
  } else if (status == kStopped || was_asked_to_stop(status) || (interrupted && killed())) {
    record_.state = AttemptState::kStopped;
  } else {
    record_.state = AttemptState::kFailed;
    take_error(folder_.output(room_.name), record_);
    if (record_.message.empty()) {
      record_.message = status > 128 ? fmt::format("signal {} ended it", status - 128)
                                     : fmt::format("it ended with status {}", status);
      record_.remedy = status == 128 + SIGKILL
                           ? "where memory ran out, use fewer --jobs or give the room --memory; else see "
                           : "see ";
      record_.remedy += folder_.log(room_.name).string();
    }
  }
  write_room_record(folder_.record(room_.name), record_);
  return record_;
}

}  // namespace aligngs
