// `aligngs batch LIST -o DIR`: many rooms, on this machine or as one of many workers of a cluster.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "batch/batch_status.h"
#include "batch/job_script.h"
#include "batch/memory_forecast.h"
#include "batch/option_words.h"
#include "batch/shard.h"
#include "batch/worker.h"
#include "cli/batch_command.h"
#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "core/log.h"
#include "core/memory_budget.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr double kBudgetShare = 0.8;  // of the free memory, as a single run takes
constexpr int kTasksAtATime = 4;      // of a printed script without --jobs

struct BatchCommandOptions {
  std::string list, output, shard, print;
  int shards = 0;  ///< 0: the environment tells
  BatchWorkOptions work;
};

Batch batch_of(const std::string& list) { return {fs::absolute(list).lexically_normal(), read_room_list(list)}; }

std::string script_of(const BatchCommandOptions& options, const Batch& batch) {
  const BatchFolder folder(options.output);
  uint64_t most = 0;
  for (const RoomEntry& room : batch.rooms) most = std::max(most, predicted_room_bytes(folder, batch, room));
  ScriptOptions script;
  script.list = batch.list;
  script.folder = folder.path();
  script.tasks = options.shards > 0 ? options.shards : static_cast<int>(batch.rooms.size());
  script.at_a_time = options.work.jobs > 0 ? options.work.jobs : kTasksAtATime;
  script.memory_gigabytes = static_cast<double>(most) * 1e-9;
  return options.print == "slurm"        ? slurm_script(script)
         : options.print == "kubernetes" ? kubernetes_manifest(script)
                                         : parallel_script(script);
}

Shard shard_of(const BatchCommandOptions& options) {
  if (!options.shard.empty()) return parse_shard(options.shard);
  return shard_from_environment([](const char* name) { return std::getenv(name); }, options.shards);
}

void run_batch(const BatchCommandOptions& options, const CommandContext& context) {
  if (options.list.empty()) throw_usage("the list of rooms is missing", "aligngs batch LIST -o DIR");
  if (options.output.empty())
    throw_usage("the folder of the batch is missing", "aligngs batch " + quote_word(options.list) + " -o DIR");
  const Batch batch = batch_of(options.list);
  if (!options.print.empty()) {
    std::fputs(script_of(options, batch).c_str(), stdout);
    return;
  }
  const Shard shard = shard_of(options);
  const BatchFolder folder(options.output);
  folder.prepare(batch);
  const std::vector<RoomEntry> rooms = rooms_of_shard(batch.rooms, shard);
  if (!shard.from.empty())
    log_info("part {} of {} by {}: {} of {} rooms", shard.index, shard.count, shard.from, rooms.size(),
             batch.rooms.size());
  work_and_report(folder, batch, rooms, options.work, context);
}

WorkerOptions worker_options(const BatchWorkOptions& options, const CommandContext& context) {
  WorkerOptions worker;
  worker.attempt.program = own_program();
  worker.jobs = std::max(1, options.jobs);
  const int threads =
      context.global.threads > 0 ? context.global.threads : static_cast<int>(std::thread::hardware_concurrency());
  worker.attempt.threads = std::max(1, threads / worker.jobs);
  if (context.global.offline) worker.attempt.global_options.push_back("--offline");
  worker.memory_bytes = options.memory_gigabytes > 0
                            ? static_cast<uint64_t>(options.memory_gigabytes * 1e9)
                            : static_cast<uint64_t>(kBudgetShare * static_cast<double>(available_memory_bytes()));
  worker.times.stale_seconds = options.stale_seconds;
  worker.times.renew_seconds = std::min(worker.times.renew_seconds, options.stale_seconds / 4);
  return worker;
}

}  // namespace

void add_batch_work_options(CLI::App& command, BatchWorkOptions& options) {
  command.add_option("--jobs", options.jobs, "rooms at a time (default 1); in a printed script tasks at a time")
      ->check(CLI::Range(1, 1000))
      ->group("Machine");
  command
      .add_option("--memory", options.memory_gigabytes,
                  "memory of all rooms at a time in GB (default: 80 % of the free memory)")
      ->check(positive_number())
      ->group("Machine");
  command
      .add_option("--stale", options.stale_seconds,
                  "seconds without a sign of life after which a worker counts as dead")
      ->check(CLI::Range(1, 86400))
      ->capture_default_str()
      ->group("Machine");
}

void work_and_report(const BatchFolder& folder, const Batch& batch, const std::vector<RoomEntry>& rooms,
                     const BatchWorkOptions& options, const CommandContext& context) {
  const WorkerSummary summary = work_on(folder, batch, rooms, worker_options(options, context));
  if (summary.interrupted) {
    throw Error({ErrorKind::kInterrupted,
                 fmt::format("stopped; {} of {} rooms are done", summary.done.size(), rooms.size()),
                 {},
                 {},
                 "run the same command again: rooms go on from their checkpoints"});
  }
  if (!summary.failed.empty()) {
    const std::string& first = summary.failed.front();
    throw Error(
        {ErrorKind::kFailed,
         fmt::format("{} of {} rooms failed: {}", summary.failed.size(), rooms.size(), join_words(summary.failed)),
         {},
         {},
         fmt::format("see aligngs batch status {}; then {}", quote_word(folder.path().string()),
                     retry_command(folder, first))});
  }
  if (!summary.stopped.empty()) {
    throw Error({ErrorKind::kInterrupted,
                 "rooms were stopped from outside: " + join_words(summary.stopped),
                 {},
                 {},
                 "run the same command again"});
  }
  if (context.global.json) {
    print_json(nlohmann::ordered_json{{"done", summary.done},
                                      {"failed", summary.failed},
                                      {"stopped", summary.stopped},
                                      {"elsewhere", summary.elsewhere}});
    return;
  }
  std::printf(
      "%zu of %zu rooms are done%s\n", summary.done.size(), rooms.size(),
      summary.elsewhere.empty() ? "" : fmt::format(", {} are with other workers", summary.elsewhere.size()).c_str());
  std::printf("figures      aligngs batch collect %s\n", quote_word(folder.path().string()).c_str());
}

void add_batch_command(CLI::App& program, CommandContext& context) {
  CLI::App* command =
      program.add_subcommand("batch", "Reconstruct many rooms: a local queue, or one worker of a cluster");
  command->group("Reconstruct");
  command->footer(
      help_footer({.reads = "LIST: TSV with room, source and options, or TOML; one room a line",
                   .writes = "DIR: rooms/NAME, which is a run folder; records, leases and logs",
                   .example = "aligngs batch rooms.tsv -o rooms --jobs 2",
                   .advanced = "aligngs batch rooms.tsv -o rooms --print slurm > job.sh",
                   .notes = "A source is a folder of photos, a scene, or the word demo for a synthetic room.\n"
                            "Finished rooms are left alone. Stopped rooms go on from their checkpoints.\n"
                            "Any number of workers share DIR. Arrays of Slurm, Kubernetes and AWS tell their part."}));
  auto options = std::make_shared<BatchCommandOptions>();
  command->add_option("list", options->list, "the list of rooms");
  command->add_option("-o,--output", options->output, "folder of the batch")->group("Output folder");
  command->add_option("--shard", options->shard, "only part i of N, as i/N with i from 1")->group("Cluster");
  command
      ->add_option(
          "--shards", options->shards,
          "parts of an array whose number comes from the environment; of a printed script (default: one a room)")
      ->check(CLI::Range(1, 1000000))
      ->group("Cluster");
  command
      ->add_option("--print", options->print, "print a script for a cluster instead of working; nothing is submitted")
      ->check(CLI::IsMember({"slurm", "kubernetes", "parallel"}))
      ->group("Cluster");
  add_batch_work_options(*command, options->work);
  add_batch_status_command(*command, context);
  add_batch_collect_command(*command, context);
  add_batch_retry_command(*command, context);
  command->callback([&context, options, command] {
    if (command->get_subcommands().empty()) run_batch(*options, context);
  });
}

}  // namespace aligngs
