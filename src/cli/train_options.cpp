#include "cli/train_options.h"

#include <CLI/CLI.hpp>

#include "cli/device_option.h"
#include "core/error.h"

namespace aligngs {

void add_train_options(CLI::App& command, const std::shared_ptr<TrainCommandOptions>& options) {
  command.add_option("-n,--iterations", options->iterations, "training iterations (default: the preset's)")->check(CLI::PositiveNumber);
  command.add_option("--preset", options->preset, "preview, default, paper, high or pgsr")
      ->check(CLI::IsMember({"preview", "default", "paper", "high", "pgsr"}));
  command.add_option("--config", options->config_file, "TOML file with settings");
  command.add_option("--set", options->sets, "override one setting, e.g. --set loss.ssim=0.3 (repeatable; --print-config lists them)");
  command.add_option("--seed", options->seed, "seed of everything random")->check(CLI::NonNegativeNumber);
  command.add_flag("--resume", options->resume, "go on with the run in the output folder; -n beyond its end extends it");
  command.add_flag("--overwrite", options->overwrite, "replace the run in the output folder");
  command.add_flag("--require-priors", options->require_priors, "missing depth or semantics are an error (status 4)");
  command.add_flag("--strict", options->strict, "a photo or view that cannot be used is an error (status 3) instead of being left out");
  add_device_option(command, options->device);
  command.add_option("--memory", options->memory_gigabytes, "memory budget in GB (default: 80 % of what is free)")->check(CLI::PositiveNumber);
  command.add_flag("--view", options->view, "show the page of `aligngs view` meanwhile, and afterwards until Ctrl-C");
  command.add_option("--view-port", options->view_port, "its port on 127.0.0.1 (default: the first free one from 7860 on)")
      ->check(CLI::Range(1, 65535));
}

void add_refine_options(CLI::App& command, const std::shared_ptr<TrainCommandOptions>& options) {
  const auto set = [options](const char* value) {
    return [options, value](int64_t) {
      for (const char* key : {"data.refine_cameras=", "data.measure_depth="}) options->refine_sets.push_back(std::string(key) + value);
    };
  };
  const std::string what = "correct cameras, focal length and prior depth from matches between the photos first, or measure "
                           "depth where there is none (see `aligngs refine`)";
  command.add_flag_function("--refine", set("true"), what + "; all presets but `paper` and `pgsr` do");
  command.add_flag_function("--no-refine", set("false"), "keep cameras and prior depth as they are");
}

TrainOptions train_options(const TrainCommandOptions& options, const CommandContext& context) {
  if (options.resume && options.overwrite) throw_usage("--resume and --overwrite contradict each other", "give one of them");
  TrainOptions train;
  train.make_engine = engine_of_device(options.device);
  train.run = options.output;
  train.config.preset = options.preset;
  train.config.config_file = options.config_file;
  train.config.sets = options.refine_sets;
  train.config.sets.insert(train.config.sets.end(), options.sets.begin(), options.sets.end());
  if (options.iterations > 0) train.config.iterations = options.iterations;
  if (options.seed >= 0) train.config.seed = options.seed;
  train.threads = context.global.threads;
  train.resume = options.resume;
  train.overwrite = options.overwrite;
  train.require_priors = options.require_priors;
  train.strict = options.strict;
  train.memory_limit = static_cast<uint64_t>(options.memory_gigabytes * 1e9);
  train.command_line = context.command_line;
  train.progress = context.progress();
  return train;
}

}  // namespace aligngs
