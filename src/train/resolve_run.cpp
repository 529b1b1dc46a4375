// Settings of a run: new, resumed, or extended.
#include <fmt/format.h>

#include "core/error.h"
#include "train/checkpoint.h"
#include "train/config_keys.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/train_run.h"

namespace aligngs {

namespace {

/// A run that stopped wrote a checkpoint. Without it training would begin again, and replace what there is.
void require_checkpoints_of_stopped(const RunFolder& folder, const RunRecord& record, bool has_checkpoints) {
  if (has_checkpoints || record.status != RunStatus::kStopped || record.train.iterations == 0) return;
  throw_bad_input(
      folder.checkpoints(), "",
      fmt::format("the training stopped after {} iterations, and its checkpoints are gone", record.train.iterations),
      "put them back, or start again with --overwrite");
}

}  // namespace

ResolvedRun resolve_run(const TrainOptions& options) {
  if (options.resume && options.overwrite)
    throw_usage("--resume and --overwrite contradict each other", "use one of them");
  const RunFolder folder(options.run);
  ResolvedRun resolved;
  resolved.exists = options.resume && std::filesystem::exists(folder.config());
  if (options.resume && std::filesystem::exists(folder.record())) resolved.record = read_run_record(folder.record());
  if (!resolved.exists) {
    resolved.config = resolve_config(options.config);
    return resolved;
  }
  ConfigSources own;
  own.config_file = folder.config();
  resolved.config = resolve_config(own);
  const int64_t old_end = resolved.config.train.iterations;
  // Settings on the command line of a resumed run may repeat the old ones, so that the same command line can be used
  // again. They may not change them: the first part of the run used the old ones.
  if (options.config.any()) {
    ConfigSources given = options.config;
    if (given.config_file.empty() && given.preset.empty()) given.config_file = own.config_file;
    TrainConfig wanted = resolve_config(given);
    wanted.train.iterations = old_end;
    wanted.train.schedule_iterations = resolved.config.train.schedule_iterations;
    const std::vector<std::string> differences = config_differences(resolved.config, wanted);
    if (!differences.empty()) {
      throw Error({ErrorKind::kUsage,
                   "a resumed run keeps its settings, but others are given: " + differences.front(),
                   folder.config(),
                   {},
                   "leave them out, or start again with --overwrite"});
    }
  }
  // Both: a run that is being extended may have been killed between writing config.toml and run.json.
  const bool finished =
      resolved.record && !resolved.record->trained.empty() && resolved.record->train.iterations >= old_end;
  const int64_t end = options.config.iterations.value_or(old_end);
  if (end < old_end) {
    throw Error({ErrorKind::kUsage, fmt::format("the run has {} iterations, fewer cannot be asked for", old_end),
                 folder.config(), "-n", "leave -n out, or start again with --overwrite"});
  }
  const bool has_checkpoints = !list_checkpoints(folder.checkpoints()).empty();
  if (!finished && resolved.record) require_checkpoints_of_stopped(folder, *resolved.record, has_checkpoints);
  const bool may_go_on = has_checkpoints ? latest_checkpoint_is_trainable(folder.checkpoints()) : !finished;
  if (end > old_end && !may_go_on) {
    throw Error(
        {ErrorKind::kUsage,
         fmt::format(
             "training cannot go on beyond iteration {}: this finished run did not keep the state of its optimiser",
             old_end),
         folder.checkpoints(), "checkpoint.keep_finished",
         fmt::format("train again with --overwrite -n {}; a run that may have to go on needs --set "
                     "checkpoint.keep_finished=true",
                     end)});
  }
  if (end > old_end) {
    if (resolved.config.train.schedule_iterations == 0) resolved.config.train.schedule_iterations = old_end;
    set_config(resolved.config, "train.iterations", ConfigValue(end));
    resolved.extended = true;
  }
  resolved.finished = finished && !resolved.extended;
  return resolved;
}

}  // namespace aligngs
