#include "train/camera_outputs.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/file_system_error.h"
#include "io/json_text.h"
#include "scene/colmap_model.h"
#include "train/run_record.h"
#include "train/training_set.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

bool contains(const std::vector<int>& list, int index) {
  return std::find(list.begin(), list.end(), index) != list.end();
}

void write_json(const fs::path& path, const Json& json) { write_file_atomically(path, json_document(json)); }

/// The layout that 3DGS viewers read (position and rotation are camera to world, OpenCV axes), plus the
/// principal point and the split.
void write_cameras(const fs::path& path, const Scene& scene, const TrainConfig& config) {
  Json cameras = Json::array();
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const int index = static_cast<int>(v);
    const bool train = contains(scene.train, index);
    if (!train && !contains(scene.test, index)) continue;
    const Camera camera = working_camera(scene, config, index);
    const Rigidd pose = camera.world_to_camera.inverse();
    Json rotation = Json::array();
    for (int r = 0; r < 3; ++r) rotation.push_back({pose.rotation(r, 0), pose.rotation(r, 1), pose.rotation(r, 2)});
    cameras.push_back({{"id", v},
                       {"img_name", scene.views[v].name},
                       {"width", camera.width},
                       {"height", camera.height},
                       {"position", {pose.translation.x, pose.translation.y, pose.translation.z}},
                       {"rotation", rotation},
                       {"fx", camera.fx},
                       {"fy", camera.fy},
                       {"cx", camera.cx},
                       {"cy", camera.cy},
                       {"split", train ? "train" : "test"}});
  }
  write_json(path, cameras);
}

void write_sparse(const fs::path& folder, const Scene& scene) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw_resources(folder, "the folder cannot be created: " + error.message(), remedy_for_write(error.value()));
  ColmapModel model;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    if (!contains(scene.train, static_cast<int>(v)) && !contains(scene.test, static_cast<int>(v))) continue;
    append_view(model, scene.views[v].camera, image_name_of(scene, scene.views[v]));
  }
  append_points(model, scene.cloud);
  write_colmap_binary(folder, model);
}

/// Nerfstudio's layout: camera to world, OpenGL axes (x right, y up, z backward).
void write_transforms(const fs::path& path, const Scene& scene) {
  Json frames = Json::array(), train_names = Json::array(), test_names = Json::array();
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const int index = static_cast<int>(v);
    const bool train = contains(scene.train, index);
    if (!train && !contains(scene.test, index)) continue;
    const View& view = scene.views[v];
    const Camera& camera = view.camera;
    const Rigidd pose = camera.world_to_camera.inverse();
    Json matrix = Json::array();
    for (int r = 0; r < 3; ++r) {
      matrix.push_back({pose.rotation(r, 0), -pose.rotation(r, 1), -pose.rotation(r, 2), pose.translation[r]});
    }
    matrix.push_back({0, 0, 0, 1});
    const std::string file = relative_scene_path(path.parent_path(), view.image);
    (train ? train_names : test_names).push_back(file);
    frames.push_back({{"file_path", file},
                      {"w", camera.width},
                      {"h", camera.height},
                      {"fl_x", camera.fx},
                      {"fl_y", camera.fy},
                      {"cx", camera.cx},
                      {"cy", camera.cy},
                      {"transform_matrix", matrix}});
  }
  Json out = {{"camera_model", "OPENCV"}};
  out["train_filenames"] = train_names;
  if (!test_names.empty()) out["test_filenames"] = test_names;
  out["frames"] = frames;
  write_json(path, out);
}

}  // namespace

void write_camera_outputs(const RunFolder& folder, const Scene& scene, const TrainConfig& config) {
  write_cameras(folder.cameras(), scene, config);
  write_sparse(folder.sparse(), scene);
  write_transforms(folder.transforms(), scene);
}

}  // namespace aligngs
