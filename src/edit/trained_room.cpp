#include "edit/trained_room.h"

#include <future>
#include <string>
#include <utility>

#include "core/error.h"
#include "edit/corrected_labels.h"
#include "edit/mesh_rows.h"
#include "edit/room_up.h"
#include "gaussians/gaussian_ply.h"
#include "scene/mesh_ply.h"
#include "train/run_folder.h"
#include "train/voted_objects.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// With the labels of the file.
LabelledGaussians read_finished_room(const OpenedRun& run, ThreadPool& pool) {
  const RunFolder paths(run.folder);
  const Scene& scene = run.scene;
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

EditableRoom read_trained_room(const OpenedRun& run, ThreadPool& pool) {
  EditableRoom room;
  const fs::path mesh_file = run.folder / "mesh" / "mesh.ply";
  std::future<TriangleMesh> mesh;  // read beside the Gaussians
  if (fs::exists(mesh_file)) mesh = std::async(std::launch::async, [&] { return read_mesh_ply(mesh_file); });
  if (run.has_finished_room()) {
    room.gaussians = read_finished_room(run, pool);
  } else {
    TrainingState state = read_trained_state(run, CheckpointParts::kWithoutEngineArrays);
    room.gaussians = label_objects(std::move(state.engine.model), run.scene.labels, robust_extent(run.scene), pool);
  }
  room.labels = run.scene.labels;
  room.metric = run.scene.metric;
  room.up = up_of_room(run.scene, room.gaussians);
  for (const int view : run.scene.train) room.cameras.push_back(run.working_camera(view));
  // Segments tell touching things apart better than their waists.
  const bool part_things = !votes_for_objects(run.scene, run.config);
  correct_labels(room.gaussians, room.labels, {room.cameras, room.up, part_things}, pool);
  room.origins.reserve(room.gaussians.model.size());
  for (uint32_t i = 0; i < room.gaussians.model.size(); ++i) room.origins.push_back({i, false, i});
  if (mesh.valid()) room.mesh = mesh.get();
  number_mesh(room);
  return room;
}

}  // namespace aligngs
