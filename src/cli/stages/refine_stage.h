// Work on a scene before a run, into the run's own scene folder: depth measured, or cameras and prior depth refined.
// pipeline/scene_decisions.h decides which.
#pragma once

#include <filesystem>
#include <string>

#include "cli/command.h"
#include "scene/scene.h"
#include "train/config.h"

namespace aligngs {

/// Measures the depth of `scene` (whose folder may be RUN/scene itself) and puts the result in RUN/scene, whole or not at all.
/// Logs the share that could be measured. Without any, a warning and false.
bool measure_into_run(const Scene& scene, const std::filesystem::path& run, const TrainConfig& config,
                      const CommandContext& context);

struct CompletedScene {
  bool written = false;     ///< RUN/scene is there; otherwise nothing was to be done
  std::string camera_note;  ///< how well the cameras agree with the photos; empty where that was not measured
};

/// Completes `scene` (whose folder may be RUN/scene itself) and puts the result in RUN/scene, whole or not at all; says what
/// was found.
CompletedScene complete_into_run(const Scene& scene, const std::filesystem::path& run, const TrainConfig& config,
                                 const CommandContext& context);

/// Refines `scene` (whose folder may be RUN/scene itself) and puts the result in RUN/scene, whole or not at all. Says
/// how far the photos agreed before and after. Error{kBadInput} for a scene without prior depth.
void refine_into_run(const Scene& scene, const std::filesystem::path& run, const TrainConfig& config,
                     const CommandContext& context);

}  // namespace aligngs
