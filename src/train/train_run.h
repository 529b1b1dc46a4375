// `aligngs train`: a scene folder in, a trained run folder out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "engine/engine.h"
#include "gaussians/soft_labels.h"
#include "train/config_file.h"
#include "train/run_record.h"

namespace aligngs {

/// Makes the engine. threads as in TrainOptions.
using EngineFactory = std::function<std::unique_ptr<Engine>(int threads)>;

struct TrainOptions {
  std::filesystem::path scene;  ///< may be empty when resuming: run.json knows it
  std::filesystem::path run;
  ConfigSources config;       ///< preset, config file, --set, -n, --seed
  EngineFactory make_engine;  ///< of the device to train on; empty: the CPU
  int threads = 0;            ///< 0: all hardware threads; the result does not depend on it
  bool resume = false, overwrite = false;
  bool require_priors = false;   ///< missing depth or semantics are Error{kWeights} instead of a warning
  bool labels_unwanted = false;  ///< a scene without semantics was asked for: no warning
  bool strict = false;           ///< a view that cannot be used is Error{kBadInput} instead of being left out
  uint64_t memory_limit = 0;     ///< bytes; 0: 80 % of what is free
  std::string command_line;      ///< as typed, for run.json
  std::string camera_note;       ///< of the check of a sensor's cameras, for run.json
  std::string resume_command;    ///< shown after an interruption; empty: "aligngs train SCENE -o RUN --resume"
  ProgressStyle progress;
};

struct TrainResult {
  bool already_finished = false;  ///< --resume on a finished run: nothing was changed
  int64_t iterations = 0;         ///< completed
  uint64_t gaussians = 0;
  double seconds = 0;  ///< training time over all resumes
  double psnr = 0;     ///< running mean over the last training views, dB
  std::vector<std::string> warnings;
  std::shared_ptr<const SoftLabels> soft;  ///< smoothed_labels() of the rows; null without labels, and already_finished
};

/// Checks every file of the scene first, then the memory, then trains. The settings of a run that is resumed come from
/// its config.toml; settings given as well must agree with it. Iterations alone may grow: the schedules then keep their
/// old end and the rates their final values. Errors: kUsage (folder rules, settings), kBadInput (scene), kWeights
/// (require_priors), kResources, kInterrupted (checkpoint written), kFailed. After the folder has been prepared every
/// end is recorded in run.json.
TrainResult train_run(const TrainOptions& options);
/// With another engine than the options'.
TrainResult train_run(const TrainOptions& options, const EngineFactory& make_engine);

/// The settings a run would have: of its config.toml when it is resumed, else from the sources.
struct ResolvedRun {
  TrainConfig config;
  bool exists = false;                   ///< config.toml exists in the folder and resume is set
  bool finished = false;                 ///< trained to config.train.iterations already
  bool extended = false;                 ///< iterations were raised beyond the old end
  std::optional<RunRecord> record = {};  ///< run.json as it was found, when resume is set
};
ResolvedRun resolve_run(const TrainOptions& options);

}  // namespace aligngs
