#include "cli/train_options.h"

#include <CLI/App.hpp>

#include "cli/device_option.h"
#include "cli/number_checks.h"
#include "core/error.h"

namespace aligngs {

void add_train_options(CLI::App& command, const std::shared_ptr<TrainCommandOptions>& options) {
  const char* const training = "Training";
  const char* const folder = "Output folder";
  const char* const page = "Page";
  command.add_option("-n,--iterations", options->iterations, "training iterations (default: the preset's)")
      ->check(positive_number())
      ->group(training);
  command.add_option("--preset", options->preset, joined_words<Preset>(", ", " or "))
      ->check(CLI::IsMember(choice_list<Preset>()))
      ->group(training);
  command.add_option("--config", options->config_file, "TOML file with settings")->group(training);
  command
      .add_option(
          "--set", options->sets,
          "override one setting, e.g. --set loss.ssim=0.3 (repeatable; `aligngs train --print-config` lists all)")
      ->group(training);
  command
      .add_option("--ignore", options->ignore,
                  "classes to leave out of the photos, e.g. \"person, cat, dog\", or none (default: person)")
      ->group(training);
  command.add_option("--seed", options->seed, "seed of all random numbers")->check(number_from_zero())->group(training);
  command
      .add_flag("--resume", options->resume,
                "continue the run in the output folder; a larger -n extends it, if it has checkpoint.keep_finished")
      ->group(folder);
  command.add_flag("--overwrite", options->overwrite, "replace the run in the output folder")->group(folder);
  command
      .add_flag("--require-priors", options->require_priors, "missing depth or class priors are an error (status 4)")
      ->group(training);
  command
      .add_flag("--strict", options->strict,
                "a photo or view that cannot be used is an error (status 3); without this it is left out")
      ->group(training);
  add_device_option(command, options->device);
  command.add_option("--memory", options->memory_gigabytes, "memory budget in GB (default: 80 % of the free memory)")
      ->check(positive_number())
      ->group("Machine");
  command
      .add_flag("--view", options->view,
                "serve the page of `aligngs view` during the work, and afterwards until Ctrl-C")
      ->group(page);
  command
      .add_option("--view-port", options->view_port,
                  "port of the page on localhost (default: the first free one from 7860)")
      ->check(CLI::Range(1, 65535))
      ->group(page);
}

void add_refine_options(CLI::App& command, const std::shared_ptr<TrainCommandOptions>& options) {
  const auto set = [options](const char* value) {
    return [options, value](int64_t) {
      for (const char* key : {"data.refine_cameras=", "data.measure_depth=", "data.sensor_cameras="})
        options->refine_sets.push_back(std::string(key) + value);
    };
  };
  const char* const group = "Refinement before training";
  const std::string what =
      "first correct cameras, focal length and prior depth from the photos, or measure missing depth "
      "(see `aligngs refine`)";
  command.add_flag_function("--refine", set("true"), what + "; the default of all presets except `paper` and `pgsr`")
      ->group(group);
  command.add_flag_function("--no-refine", set("false"), "keep cameras and prior depth as they are")->group(group);
}

TrainOptions train_options(const TrainCommandOptions& options, const CommandContext& context) {
  if (options.resume && options.overwrite)
    throw_usage("--resume and --overwrite contradict each other", "give one of them");
  TrainOptions train;
  train.make_engine = engine_of_device(options.device);
  train.run = options.output;
  train.config.preset = options.preset;
  train.config.config_file = options.config_file;
  train.config.sets = options.refine_sets;
  if (options.ignore)
    train.config.sets.push_back("data.ignore=" + (*options.ignore == "none" ? std::string() : *options.ignore));
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
