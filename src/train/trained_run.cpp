#include "train/trained_run.h"

#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "scene/ignored_classes.h"
#include "scene/view_data.h"
#include "train/config_file.h"
#include "train/run_folder.h"

namespace aligngs {

namespace fs = std::filesystem;

void require_run_folder(const fs::path& folder) {
  if (fs::exists(RunFolder(folder).record())) return;
  throw_bad_input(folder, "run.json", "this is no run folder",
                  "give a folder that `aligngs train` or `aligngs run` made");
}

TrainedRun read_run_without_state(const fs::path& folder, const fs::path& scene) {
  require_run_folder(folder);
  const RunFolder paths(folder);
  TrainedRun run;
  run.record = read_run_record(paths.record());
  apply_config_file(paths.config(), run.config);
  const fs::path scene_folder = scene_of_run(folder, run.record, scene);
  if (!fs::exists(scene_folder)) {
    throw_bad_input(scene_folder, "scene", "the scene of this run is not where run.json says",
                    "say where it is now: --scene DIR");
  }
  run.scene = open_scene(scene_folder);
  run.scene.ignored = ignored_classes(run.scene.labels, run.config.data.ignore);
  leave_out_views(run.scene, run.record.left_out);
  if (!run.record.fingerprint.empty() && run.record.fingerprint != scene_fingerprint(run.scene)) {
    log_warning("the scene in {} has changed since this run was trained", scene_folder.string());
  }
  return run;
}

TrainedRun read_trained_run(const fs::path& folder, const fs::path& scene, CheckpointParts parts) {
  TrainedRun run = read_run_without_state(folder, scene);
  const RunFolder paths(folder);
  std::optional<TrainingState> state = read_latest_checkpoint(paths.checkpoints(), run.record.fingerprint, parts);
  if (!state && fs::exists(paths.scene_ply())) {
    throw_bad_input(paths.checkpoints(), "",
                    "the checkpoints of this run are gone or damaged; scene.ply alone has no labels to resume with",
                    "put them back, or train again with `aligngs train ... --overwrite`; scene.ply opens in any viewer "
                    "of Gaussians");
  }
  if (!state)
    throw_bad_input(paths.checkpoints(), "", "nothing has been trained here yet",
                    "run `aligngs train ... --resume` first");
  run.state = std::move(*state);
  apply_motions(run.state.motions, run.scene);
  return run;
}

}  // namespace aligngs
