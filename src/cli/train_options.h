// Command-line options that `train`, `run` and `demo` share.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "train/train_run.h"

namespace aligngs {

struct TrainCommandOptions {
  std::string preset, config_file, output, device = "auto";
  std::vector<std::string> sets;
  std::optional<std::string> ignore;     ///< of --ignore, short for data.ignore
  std::vector<std::string> refine_sets;  ///< of --refine and --no-refine; `sets` come after them
  int64_t iterations = 0, seed = -1;     ///< 0 and -1: not given
  bool resume = false, overwrite = false, require_priors = false, strict = false;
  double memory_gigabytes = 0;
  bool view = false;       ///< show the page meanwhile (page_server.h)
  uint16_t view_port = 0;  ///< 0: the first free one
};

/// Adds -n, --preset, --config, --set, --seed, --resume, --overwrite, --device, ... to a command.
void add_train_options(CLI::App& command, const std::shared_ptr<TrainCommandOptions>& options);

/// --refine and --no-refine, short for data.refine_cameras, data.measure_depth and data.sensor_cameras.
void add_refine_options(CLI::App& command, const std::shared_ptr<TrainCommandOptions>& options);

/// Error{kUsage} for contradictions, Error{kResources} for a device that this program has not.
TrainOptions train_options(const TrainCommandOptions& options, const CommandContext& context);

}  // namespace aligngs
