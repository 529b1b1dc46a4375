#include "edit/trained_room.h"

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "edit/mesh_rows.h"
#include "edit/room_up.h"
#include "edit/shell_labels.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "scene/mesh_ply.h"
#include "train/run_folder.h"
#include "train/trained_run.h"
#include "train/training_set.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t kMostCameras = uint64_t(16) << 20;  // bytes of cameras.json

/// Whether scene.ply is what the training came to.
bool has_finished_room(const fs::path& run, const RunRecord& record) {
  const RunFolder paths(run);
  if (!fs::exists(paths.scene_ply())) return false;
  return !record.trained.empty() || list_checkpoints(paths.checkpoints()).empty();
}

/// Training cameras that moved: cameras.json has them where they ended.
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

/// With the labels of the file.
LabelledGaussians read_finished_room(const fs::path& run, const Scene& scene, ThreadPool& pool) {
  const RunFolder paths(run);
  const double extent = robust_extent(scene);
  if (!fs::exists(paths.labelled_ply()))
    return label_objects(read_gaussian_ply(paths.scene_ply()), scene.labels, extent, pool);
  LabelledModel file = read_labelled_gaussian_ply(paths.labelled_ply());
  for (size_t i = 0; i < file.labels.label.size(); ++i) {
    const uint16_t label = file.labels.label[i];
    if (label != kNoLabel && label >= scene.labels.classes.size()) {
      throw_bad_input(paths.labelled_ply(), "label",
                      "Gaussian " + std::to_string(i) + " has class " + std::to_string(label) +
                          ", which the scene's label set does not have",
                      "give the scene that this run was trained on: --scene DIR");
    }
  }
  LabelledGaussians room;
  room.extent = extent > 0 ? extent : extent_of(file.model);
  room.model = std::move(file.model);
  room.labels = std::move(file.labels);
  room.labels.label_set = scene.labels.name;
  room.named = true;
  return room;
}

}  // namespace

TrainedRoom read_trained_room(const fs::path& run, const fs::path& scene, ThreadPool& pool) {
  require_run_folder(run);
  TrainedRoom out;
  if (has_finished_room(run, read_run_record(RunFolder(run).record()))) {
    TrainedRun opened = read_run_without_state(run, scene);
    out.record = std::move(opened.record);
    out.config = std::move(opened.config);
    out.scene = std::move(opened.scene);
    if (out.config.optimizer.pose_rotation > 0 || out.config.optimizer.pose_translation > 0)
      apply_written_cameras(RunFolder(run).cameras(), out.scene);
    out.room.gaussians = read_finished_room(run, out.scene, pool);
  } else {
    TrainedRun opened = read_trained_run(run, scene, CheckpointParts::kWithoutEngineArrays);
    out.record = std::move(opened.record);
    out.config = std::move(opened.config);
    out.scene = std::move(opened.scene);
    out.room.gaussians =
        label_objects(std::move(opened.state.engine.model), out.scene.labels, robust_extent(out.scene), pool);
  }
  EditableRoom& room = out.room;
  room.labels = out.scene.labels;
  room.up = up_of_room(out.scene, room.gaussians);
  for (const int view : out.scene.train) room.cameras.push_back(working_camera(out.scene, out.config, view));
  correct_shell_labels(room.gaussians, room.labels, room.cameras, pool);
  room.origins.reserve(room.gaussians.model.size());
  for (uint32_t i = 0; i < room.gaussians.model.size(); ++i) room.origins.push_back({i, false, i});
  if (fs::exists(run / "mesh" / "mesh.ply")) room.mesh = read_mesh_ply(run / "mesh" / "mesh.ply");
  number_mesh(room);
  return out;
}

}  // namespace aligngs
