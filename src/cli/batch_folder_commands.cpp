// `aligngs batch status|collect|retry DIR`: what became of the rooms of a batch.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "batch/batch_status.h"
#include "cli/batch_command.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/report/batch_results.h"
#include "core/error.h"
#include "core/log.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// One word or two of what a room is about: its stage, its worker, its fault.
std::string remark(const RoomStatus& s) {
  switch (s.state) {
    case RoomState::kRunning:
      return fmt::format("{}{}",
                         s.stage.empty() ? "poses and priors" : fmt::format("{}, iteration {}", s.stage, s.iterations),
                         s.worker.empty() ? "" : " on " + s.worker);
    case RoomState::kStopped:
      return fmt::format("{}, iteration {}", s.stage, s.iterations);
    case RoomState::kFailed:
      return fmt::format("status {}: {}", s.record.exit_status, s.record.message);
    default:
      return "";
  }
}

void print_status(const std::string& path, const CommandContext& context) {
  const BatchFolder folder(path);
  const std::vector<RoomStatus> rooms = batch_status(folder, folder.read(), {});
  if (context.global.json) {
    print_json(batch_json(folder, rooms));
    return;
  }
  std::printf("%s", fmt::format("{:<24} {:<8} {:>5}  {}\n", "room", "state", "tries", "").c_str());
  std::map<std::string, int> counts;
  for (const RoomStatus& s : rooms) {
    ++counts[name_of(s.state)];
    std::printf(
        "%s",
        fmt::format("{:<24} {:<8} {:>5}  {}\n", s.room.name, name_of(s.state), s.record.attempts, remark(s)).c_str());
    if (s.state != RoomState::kFailed) continue;
    if (!s.record.remedy.empty()) std::printf("%33s remedy: %s\n", "", s.record.remedy.c_str());
    std::printf("%33s again: %s\n", "", retry_command(folder, s.room.name).c_str());
  }
  std::string total;
  for (const auto& [state, count] : counts) total += fmt::format("{}{} {}", total.empty() ? "" : ", ", count, state);
  std::printf("%s\n", total.c_str());
}

void collect(const std::string& path, const CommandContext& context) {
  const BatchFolder folder(path);
  const std::vector<RoomStatus> rooms = batch_status(folder, folder.read(), {});
  const fs::path csv = folder.path() / "results.csv", json = folder.path() / "results.json",
                 html = folder.path() / "results.html";
  write_file_atomically(csv, batch_csv(folder, rooms));
  write_batch_json(json, folder, rooms);
  write_file_atomically(html, batch_page(folder, rooms));
  if (context.global.json) {
    print_json(batch_json(folder, rooms));
    return;
  }
  for (const fs::path& file : {csv, json, html}) std::printf("%s\n", file.string().c_str());
}

struct RetryOptions {
  std::string folder;
  std::vector<std::string> rooms;
  bool from_start = false, later = false;
  BatchWorkOptions work;
};

void retry(const RetryOptions& options, const CommandContext& context) {
  const BatchFolder folder(options.folder);
  const Batch batch = folder.read();
  std::vector<RoomEntry> again;
  for (const std::string& name : options.rooms) again.push_back(batch.room(name));
  if (options.from_start && again.empty())
    throw_usage("--from-start needs names of rooms", "`aligngs batch status DIR` lists them");
  const bool named = !again.empty();
  LeaseTimes times;
  times.stale_seconds = options.work.stale_seconds;
  std::vector<RoomEntry> forgotten;
  for (const RoomEntry& room : named ? again : batch.rooms) {
    const auto record = read_room_record(folder.record(room.name));
    if (!options.from_start && (!record || record->state != AttemptState::kFailed)) {
      if (named) log_info("{}: did not fail", room.name);
      continue;
    }
    if (forget_failure(folder, room.name, options.from_start, times)) forgotten.push_back(room);
  }
  if (forgotten.empty()) throw_usage("no room failed", "`aligngs batch status DIR` lists the rooms");
  if (!options.later) return work_and_report(folder, batch, forgotten, options.work, context);
  std::printf("noted for the next `aligngs batch`: %zu of %zu rooms\n", forgotten.size(), batch.rooms.size());
}

}  // namespace

void add_batch_status_command(CLI::App& batch, CommandContext& context) {
  CLI::App* command = batch.add_subcommand("status", "List the rooms of a batch with their states");
  command->footer(
      help_footer({.reads = "DIR of a batch",
                   .writes = "a table on standard output",
                   .example = "aligngs batch status rooms",
                   .advanced = "aligngs batch status rooms --json",
                   .notes = "States: waiting, running, stopped, changed (its inputs are others), done, failed."}));
  auto folder = std::make_shared<std::string>();
  command->add_option("folder", *folder, "folder of the batch")->required();
  command->callback([&context, folder] { print_status(*folder, context); });
}

void add_batch_collect_command(CLI::App& batch, CommandContext& context) {
  CLI::App* command = batch.add_subcommand("collect", "Put the figures of all rooms into one table and one page");
  command->footer(help_footer({.reads = "DIR of a batch",
                               .writes = "DIR/results.csv, results.json and results.html",
                               .example = "aligngs batch collect rooms",
                               .advanced = "aligngs batch collect rooms --json",
                               .notes = "The page shows failures first, with the command that tries again."}));
  auto folder = std::make_shared<std::string>();
  command->add_option("folder", *folder, "folder of the batch")->required();
  command->callback([&context, folder] { collect(*folder, context); });
}

void add_batch_retry_command(CLI::App& batch, CommandContext& context) {
  CLI::App* command = batch.add_subcommand("retry", "Try failed rooms again");
  command->footer(help_footer({.reads = "DIR of a batch",
                               .writes = "the rooms that failed, from their checkpoints",
                               .example = "aligngs batch retry rooms",
                               .advanced = "aligngs batch retry rooms kitchen --from-start --later",
                               .notes = "A failed room is left alone until then, or until its inputs change."}));
  auto options = std::make_shared<RetryOptions>();
  command->add_option("folder", options->folder, "folder of the batch")->required();
  command->add_option("rooms", options->rooms, "names of rooms (default: all that failed)");
  command->add_flag("--from-start", options->from_start,
                    "discard what the named rooms have, whether they failed or not");
  command->add_flag("--later", options->later, "only note it: the next `aligngs batch` tries them");
  add_batch_work_options(*command, options->work);
  command->callback([&context, options] { retry(*options, context); });
}

}  // namespace aligngs
