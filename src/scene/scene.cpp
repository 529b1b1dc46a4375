#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "core/error.h"
#include "core/log.h"
#include "io/colmap.h"
#include "scene/mesh_ply.h"
#include "scene/not_a_scene.h"
#include "scene/photo_lookup.h"
#include "scene/scene_check.h"
#include "scene/scene_json.h"
#include "scene/scene_split.h"
#include "scene/scene_views.h"
#include "scene/view_names.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

PointCloud cloud_of(const ColmapModel& model, const fs::path& folder) {
  PointCloud cloud;
  for (const ColmapPoint& point : model.points) {
    const Vec3f position = point.position.cast<float>();
    if (!std::isfinite(norm(position))) {
      throw_bad_input(folder / "points3D", "point " + std::to_string(point.id), "the position is far beyond any scene",
                      "remove this point");
    }
    cloud.positions.push_back(position);
    cloud.colors.push_back({static_cast<float>(point.color[0]) / 255.0f, static_cast<float>(point.color[1]) / 255.0f,
                            static_cast<float>(point.color[2]) / 255.0f});
  }
  // COLMAP has no normals: our own scenes keep them in a PLY beside the points. It counts only while it holds
  // the same points in the same order (other tools rewrite either file).
  const fs::path ply = folder / "points3D.ply";
  if (cloud.size() == 0 || !fs::is_regular_file(ply)) return cloud;
  const PointCloud with_normals = read_cloud_file(ply).cloud;
  if (!with_normals.has_normals() || with_normals.size() != cloud.size()) return cloud;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (norm(with_normals.positions[i] - cloud.positions[i]) > 1e-5f * (1 + norm(cloud.positions[i]))) return cloud;
  }
  cloud.normals = with_normals.normals;
  return cloud;
}

void read_exposure(const fs::path& path, Scene& scene) {
  ExposureJson gains = read_exposure_json(path);
  for (View& view : scene.views) {
    const auto found = gains.find(view.name);
    if (found == gains.end()) continue;
    view.log_gain = found->second;
    gains.erase(found);
  }
  for (const LeftOut& view : scene.left_out) gains.erase(view.name);
  if (gains.empty()) return;
  throw_bad_input(path, "log_gains", "there is no view '" + gains.begin()->first + "'",
                  "name views of this scene, or remove the entry");
}

bool all_have(const Scene& scene, fs::path View::*map) {
  return !scene.train.empty() &&
         std::all_of(scene.train.begin(), scene.train.end(), [&](int i) { return !(scene.views[i].*map).empty(); });
}

/// Said once for a file, as a run opens its scene more than once.
void warn_of_assumed_scale(const fs::path& file) {
  static std::mutex mutex;
  static std::set<fs::path> told;
  const std::lock_guard<std::mutex> lock(mutex);
  if (!told.insert(file).second) return;
  log_warning(
      "{}: depth.scale is missing: every view's depth is taken to have an unknown scale of its own (per_view); write "
      "\"scale\": \"scene\", \"metres\", \"own\" or \"per_view\"",
      file.string());
}

}  // namespace

bool is_sensor_depth(const std::string& prior_source) {
  return prior_source == kSensorDepth || prior_source == kSimulatedSensorDepth;
}

bool Scene::has_prior_depth() const { return all_have(*this, &View::prior_depth); }
bool Scene::has_network_depth() const {
  return has_prior_depth() && !is_sensor_depth(prior_source) && prior_source != kStereoDepth;
}

bool Scene::has_semantics() const { return all_have(*this, &View::semantics); }

std::string image_name_of(const Scene& scene, const View& view) {
  for (const fs::path& folder : {scene.folder / "images", scene.folder}) {
    const fs::path inside = view.image.lexically_relative(folder);
    if (!inside.empty() && *inside.begin() != "..") return inside.generic_string();
  }
  return view.image.filename().string();
}

Scene open_scene(const fs::path& given_folder, const SceneOptions& options) {
  const fs::path folder = fs::absolute(given_folder).lexically_normal();
  if (!fs::is_directory(folder)) {
    throw_bad_input(folder, "", "this is no folder", "give the folder of a scene (images/ and sparse/)");
  }
  Scene scene;
  scene.folder = folder;
  const SceneJson description = read_scene_json(folder / "scene.json");
  scene.metric = description.metric;
  scene.units_estimate = description.units_estimate;
  scene.up = description.up;
  scene.source = description.source;
  const PriorsJson priors = read_priors_json(folder / "priors.json");
  if (priors.depth) scene.prior_source = priors.depth->model;
  scene.depth_scale = depth_scale_of(priors, description.refined);
  scene.depth_scale_stated = priors.depth_scale.has_value();
  if (assumes_depth_scale(priors, description.refined)) warn_of_assumed_scale(folder / "priors.json");
  if (priors.semantics) scene.semantic_source = priors.semantics->model;
  scene.semantic_kind = priors.kind.value_or(SemanticKind::kLogits);
  scene.semantic_kind_stated = priors.kind.has_value();
  const fs::path labels = folder / "labels.csv";
  scene.labels = fs::exists(labels) ? read_label_csv(labels) : ade20k_labels();

  refuse_what_is_no_scene(folder, given_folder);
  const fs::path model_folder = find_colmap_folder(folder);
  const ColmapModel model = read_colmap_model(model_folder);
  if (model.points_left_out > 0)
    log_warning("{}: {} points without a usable position are not used", model_folder.string(), model.points_left_out);
  scene.left_out = model.left_out;
  for (LeftOut& view : scene.left_out) view.name = view_name_of(view.name);
  if (model.images.empty()) {
    require_enough(folder, 0, scene.left_out, 1, false, "views");
    throw_bad_input(model_folder, "images", "no image is registered", "estimate poses first with `aligngs poses`");
  }
  scene.views = read_views(model, folder, model_folder, scene.left_out);
  scene.cloud = cloud_of(model, model_folder);
  read_split(folder / "split.json", options, scene);
  read_exposure(folder / "exposure.json", scene);
  if (fs::is_regular_file(folder / "truth" / "mesh.ply")) scene.truth_mesh = folder / "truth" / "mesh.ply";
  const bool has_truth = std::any_of(scene.views.begin(), scene.views.end(),
                                     [](const View& view) { return view.truth_camera.has_value(); });
  for (const View& view : scene.views) {
    if (view.truth_camera) scene.evaluation_cameras.push_back(*view.truth_camera);
    if (!has_truth) scene.evaluation_cameras.push_back(view.camera);
  }
  if (options.check_headers) leave_out_bad_views(scene, check_headers(scene));
  return scene;
}

}  // namespace aligngs
