// Work on a scene before a run, into the run's own scene folder: depth measured, or cameras and prior depth refined.
#pragma once

#include <filesystem>

#include "cli/command.h"
#include "train/config.h"

namespace aligngs {

/// Whether a run with these settings measures depth first, with a log line. data.measure_depth asks for it, prior depth
/// is wanted, and the scene has points and no prior depth.
bool should_measure(const std::filesystem::path& scene, const TrainConfig& config);

/// Measures the depth of `scene` (which may be RUN/scene itself) and puts the result in RUN/scene, whole or not at all.
/// Logs the share that could be measured. Without any, a warning and false.
bool measure_into_run(const std::filesystem::path& scene, const std::filesystem::path& run, const TrainConfig& config,
                      const CommandContext& context);

/// Whether a run with these settings corrects the cameras of the scene first. data.refine_cameras asks for it, and the
/// program was built with Ceres. Every training view has metric prior depth that training will use and that no sensor
/// made. The scene has not been refined before. Otherwise logs the reason.
bool should_refine(const std::filesystem::path& scene, const TrainConfig& config);

/// Whether a run with these settings first measures exposures (data.sensor_exposure and data.exposure) and fills holes
/// of the
/// depth (data.fill_depth). Every training view needs depth in scene units, of a sensor or given. Refining and
/// measuring depth
/// do such work themselves.
bool should_complete(const std::filesystem::path& scene, const TrainConfig& config);

/// Completes `scene` (which may be RUN/scene itself) and puts the result in RUN/scene, whole or not at all; says what
/// was found.
/// false: nothing was to be done, and nothing is written.
bool complete_into_run(const std::filesystem::path& scene, const std::filesystem::path& run, const TrainConfig& config,
                       const CommandContext& context);

/// Refines `scene` (which may be RUN/scene itself) and puts the result in RUN/scene, whole or not at all. Says how far
/// the
/// photos agreed before and after. Error{kBadInput} for a scene without prior depth.
void refine_into_run(const std::filesystem::path& scene, const std::filesystem::path& run, const TrainConfig& config,
                     const CommandContext& context);

}  // namespace aligngs
