#include "train/opened_run.h"

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "scene/ignored_classes.h"
#include "scene/view_data.h"
#include "train/config_file.h"
#include "train/run_folder.h"
#include "train/training_set.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t kMostCameras = uint64_t(16) << 20;  // bytes of cameras.json

/// Training cameras where cameras.json has them, which is where they ended.
void apply_written_cameras(const fs::path& file, Scene& scene) {
  if (!fs::exists(file)) return;
  const nlohmann::json cameras = parse_json(read_file(file, kMostCameras));
  std::map<std::string, const nlohmann::json*> named;
  try {
    for (const nlohmann::json& camera : cameras) named[camera.at("img_name").get<std::string>()] = &camera;
    for (const int v : scene.train) {
      View& view = scene.views[static_cast<size_t>(v)];
      const auto it = named.find(view.name);
      if (it == named.end()) continue;
      Rigidd pose;
      for (int r = 0; r < 3; ++r) {
        const size_t row = static_cast<size_t>(r);
        pose.translation[r] = it->second->at("position").at(row).get<double>();
        for (int c = 0; c < 3; ++c)
          pose.rotation(r, c) = it->second->at("rotation").at(row).at(static_cast<size_t>(c)).get<double>();
      }
      view.camera.world_to_camera = pose.inverse();
    }
  } catch (const nlohmann::json::exception&) {
    throw_bad_input(file, "cameras", "a camera has no name, place or rotation",
                    "write it again: aligngs train ... --resume");
  }
}

}  // namespace

Camera OpenedRun::working_camera(int view) const { return aligngs::working_camera(scene, config, view); }

bool OpenedRun::has_finished_room() const {
  const RunFolder paths(folder);
  if (!fs::exists(paths.scene_ply()) && !fs::exists(paths.labelled_ply())) return false;
  return !record.trained.empty() || list_checkpoints(paths.checkpoints()).empty();
}

void require_run_folder(const fs::path& folder) {
  if (fs::exists(RunFolder(folder).record())) return;
  if (!fs::exists(folder)) throw_bad_input(folder, "", "there is no such folder", "give the folder of a run");
  throw_bad_input(folder, "run.json", "this is no run folder",
                  "give a folder that `aligngs train` or `aligngs run` made");
}

OpenedRun open_run(const fs::path& folder, const fs::path& scene) {
  require_run_folder(folder);
  const RunFolder paths(folder);
  OpenedRun run;
  run.folder = folder;
  run.record = read_run_record(paths.record());
  if (!fs::exists(paths.config())) {
    throw_bad_input(paths.config(), "", "the settings of this run are missing",
                    "put config.toml of the run back: every stage, edit and export reads it");
  }
  apply_config_file(paths.config(), run.config);
  const fs::path scene_folder = scene_of_run(folder, run.record, scene);
  if (!fs::exists(scene_folder)) {
    throw_bad_input(scene_folder, "scene", "the scene of this run is not where run.json says",
                    "say where it is now: --scene DIR; labels, cameras and the scale come from there");
  }
  run.scene = open_scene(scene_folder);
  run.scene.ignored = ignored_classes(run.scene.labels, run.config.data.ignore);
  leave_out_views(run.scene, run.record.left_out);
  if (!run.record.fingerprint.empty() && run.record.fingerprint != scene_fingerprint(run.scene)) {
    log_warning("the scene in {} has changed since this run was trained", scene_folder.string());
  }
  return run;
}

TrainingState read_trained_state(const OpenedRun& run, CheckpointParts parts) {
  const RunFolder paths(run.folder);
  std::optional<TrainingState> state = read_latest_checkpoint(paths.checkpoints(), run.record.fingerprint, parts);
  if (!state && (!run.record.trained.empty() || fs::exists(paths.scene_ply()))) {
    throw_bad_input(paths.checkpoints(), "", "the checkpoints of this run are gone or damaged",
                    "put them back, or train again with `aligngs train ... --overwrite`; `edit`, `export` and `view` "
                    "need scene.labels.ply alone");
  }
  if (!state)
    throw_bad_input(paths.checkpoints(), "", "nothing has been trained here yet",
                    "run `aligngs train ... --resume` first");
  return std::move(*state);
}

void place_cameras(OpenedRun& run, const TrainingState& state) {
  if (run.cameras_placed) return;
  apply_motions(state.motions, run.scene);
  run.cameras_placed = true;
}

SharedRun open_run_as_trained(const fs::path& folder, const fs::path& scene) {
  OpenedRun run = open_run(folder, scene);
  const bool moved = run.config.optimizer.pose_rotation > 0 || run.config.optimizer.pose_translation > 0;
  if (moved && run.has_finished_room())
    apply_written_cameras(RunFolder(folder).cameras(), run.scene);
  else if (moved)
    place_cameras(run, read_trained_state(run, CheckpointParts::kWithoutEngineArrays));
  run.cameras_placed = true;
  return std::make_shared<const OpenedRun>(std::move(run));
}

}  // namespace aligngs
