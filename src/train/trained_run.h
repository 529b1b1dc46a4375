// A run folder as those open it who come after training: to look at its scene, to measure it, to edit it.
#pragma once

#include <filesystem>

#include "scene/scene.h"
#include "train/checkpoint.h"
#include "train/config.h"
#include "train/run_record.h"

namespace aligngs {

struct TrainedRun {
  RunRecord record;
  TrainConfig config;
  Scene scene;          ///< training cameras where training left them
  TrainingState state;  ///< of the newest good checkpoint
};

/// Error{kBadInput} unless the folder has a run.json.
void require_run_folder(const std::filesystem::path& folder);

/// The same as read_trained_run() without its state: training cameras are where the scene has them, and no checkpoint
/// is
/// looked at.
TrainedRun read_run_without_state(const std::filesystem::path& folder, const std::filesystem::path& scene);

/// `scene` says where the scene went when it is not where run.json says; may be empty. A scene that has changed since
/// it was trained is
/// a warning. Error{kBadInput} when the folder is no run, its scene cannot be found or read, nothing has been trained
/// yet, or no good
/// checkpoint is left.
TrainedRun read_trained_run(const std::filesystem::path& folder, const std::filesystem::path& scene,
                            CheckpointParts parts);

}  // namespace aligngs
