// A run folder as those open it who come after training: to look at its scene, to measure it, to edit it. It is opened
// once, and passed on.
#pragma once

#include <filesystem>
#include <memory>

#include "scene/camera.h"
#include "scene/scene.h"
#include "train/checkpoint.h"
#include "train/config.h"
#include "train/run_record.h"

namespace aligngs {

struct OpenedRun {
  std::filesystem::path folder;
  RunRecord record;
  TrainConfig config;
  Scene scene;  ///< as it was trained: without the views that were left out, and with the classes that were ignored
  bool cameras_placed = false;  ///< training cameras are where training left them; until then where the scene has them

  /// Camera of a view at the resolution at which the run worked.
  Camera working_camera(int view) const;
  /// scene.ply or scene.labels.ply is what the training came to; false where it was stopped and can go on.
  bool has_finished_room() const;
};

/// For several readers, none of which changes it.
using SharedRun = std::shared_ptr<const OpenedRun>;

/// Error{kBadInput} unless the folder has a run.json.
void require_run_folder(const std::filesystem::path& folder);

/// Reads record, settings and scene; looks at no checkpoint, and places no cameras. `scene` says where the scene went
/// when it is not where run.json says; may be empty. A scene that has changed since it was trained is a warning.
/// Error{kBadInput} when the folder is no run, or its scene cannot be found or read.
OpenedRun open_run(const std::filesystem::path& folder, const std::filesystem::path& scene);

/// The newest good checkpoint of the run. Error{kBadInput} when nothing has been trained yet, or no good checkpoint is
/// left.
TrainingState read_trained_state(const OpenedRun& run, CheckpointParts parts);

/// Places the cameras as the run's checkpoint has them.
void place_cameras(OpenedRun& run, const TrainingState& state);

/// open_run() with the cameras placed: as cameras.json has them for a finished room, else as the newest checkpoint has
/// them. Neither is read where training kept the cameras fixed. Errors as open_run's and read_trained_state's, and
/// Error{kBadInput} for a damaged cameras.json.
SharedRun open_run_as_trained(const std::filesystem::path& folder, const std::filesystem::path& scene);

}  // namespace aligngs
