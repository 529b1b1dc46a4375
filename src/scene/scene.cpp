#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "io/colmap.h"
#include "scene/mesh_ply.h"
#include "scene/scene_check.h"
#include "scene/scene_json.h"
#include "scene/undistort.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// The name of an image without its extension, keeping subfolders: "left/0001.color.png" has the view name
/// "left/0001.color" (up to the last dot) and the short name "left/0001" (up to the first dot of the file).
std::string view_name(const std::string& image_name) {
  return (fs::path(image_name).parent_path() / fs::path(image_name).stem()).generic_string();
}

std::string short_name(const std::string& image_name) {
  const fs::path path(image_name);
  const std::string file = path.filename().string();
  return (path.parent_path() / file.substr(0, file.find('.', 1))).generic_string();
}

void require_inside_folder(const std::string& image_name, const fs::path& path) {
  const fs::path name(image_name);
  bool inside = !image_name.empty() && name.is_relative() && !name.filename().empty();
  for (const fs::path& part : name) inside = inside && part != "..";
  if (!inside) {
    throw_bad_input(path, "image '" + image_name.substr(0, 200) + "'", "the name points outside of images/",
                    "write image names relative to the folder images/");
  }
}

/// The names under which the maps of an image may be found. The short name counts only while no other image has
/// it: "a.1.png" and "a.2.png" must not share the map "a.npy".
class MapNames {
 public:
  explicit MapNames(const ColmapModel& model) {
    for (const ColmapImage& image : model.images) ++uses_[short_name(image.name)];
  }

  /// The first existing <folder>/<stem><extension>; empty when there is none.
  fs::path find(const fs::path& folder, const std::string& image_name,
                std::initializer_list<const char*> extensions) const {
    std::vector<std::string> stems = {view_name(image_name)};
    const std::string brief = short_name(image_name);
    if (uses_.at(brief) == 1) stems.push_back(brief);
    for (const std::string& stem : stems) {
      for (const char* extension : extensions) {
        fs::path path = folder / (stem + extension);
        if (fs::is_regular_file(path)) return path;
      }
    }
    return {};
  }

  fs::path find_image(const fs::path& folder, const std::string& image_name) const {
    fs::path exact = folder / image_name;
    if (fs::is_regular_file(exact)) return exact;
    const fs::path other = find(folder, image_name, {".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG"});
    return other.empty() ? exact : other;  // the missing one is reported by the header check
  }

 private:
  std::map<std::string, int> uses_;
};

/// Cameras by view name.
std::map<std::string, Camera> cameras_of(const ColmapModel& model, const fs::path& folder) {
  std::map<uint32_t, LensModel> lenses;
  for (const ColmapCamera& camera : model.cameras) lenses[camera.id] = lens_of(camera, folder / "cameras");
  std::map<std::string, Camera> cameras;
  for (const ColmapImage& image : model.images) {
    const LensModel& lens = lenses.at(image.camera_id);
    if (lens.distorted()) {
      throw_bad_input(folder / "cameras", "camera " + std::to_string(image.camera_id),
                      "the lens distortion of this camera model is not removed from the images",
                      "make an undistorted scene of it with `aligngs import`");
    }
    Camera camera = lens.pinhole();
    camera.world_to_camera = {rotation_matrix(normalized(image.rotation)), image.translation};
    if (!cameras.emplace(view_name(image.name), camera).second) {
      throw_bad_input(folder / "images", "image '" + image.name + "'",
                      "two images have the name '" + view_name(image.name) + "' before the last dot",
                      "rename one of them: maps are found by that name");
    }
  }
  return cameras;
}

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
  const PointCloud with_normals = read_cloud_ply(ply);
  if (!with_normals.has_normals() || with_normals.size() != cloud.size()) return cloud;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (norm(with_normals.positions[i] - cloud.positions[i]) > 1e-5f * (1 + norm(cloud.positions[i]))) return cloud;
  }
  cloud.normals = with_normals.normals;
  return cloud;
}

std::vector<View> views_of(const ColmapModel& model, const fs::path& folder, const fs::path& model_folder) {
  const std::map<std::string, Camera> cameras = cameras_of(model, model_folder);
  std::map<std::string, Camera> truth;
  if (fs::is_directory(folder / "truth" / "sparse")) {
    const fs::path truth_folder = find_colmap_folder(folder / "truth");
    truth = cameras_of(read_colmap_model(truth_folder), truth_folder);
  }
  const MapNames maps(model);
  std::vector<View> views;
  for (const ColmapImage& image : model.images) {
    require_inside_folder(image.name, model_folder / "images");
    View view;
    view.name = view_name(image.name);
    view.camera = cameras.at(view.name);
    view.image = maps.find_image(folder / "images", image.name);
    view.prior_depth = maps.find(folder / "pred_depths", image.name, {".npy"});
    view.semantics = maps.find(folder / "segmentation_logits", image.name, {".npy", ".pt", ".pth"});
    view.truth_depth = maps.find(folder / "truth" / "depth", image.name, {".png"});
    view.truth_labels = maps.find(folder / "truth" / "labels", image.name, {".png"});
    if (const auto found = truth.find(view.name); found != truth.end()) {
      view.truth_camera = found->second.resized(view.camera.width, view.camera.height);
    }
    views.push_back(std::move(view));
  }
  std::sort(views.begin(), views.end(), [](const View& a, const View& b) { return a.name < b.name; });
  return views;
}

/// Resolves the names of split.json: view names, short names or file names.
class ViewNames {
 public:
  ViewNames(const std::vector<View>& views, const fs::path& images) {
    const int count = static_cast<int>(views.size());
    std::map<std::string, int> uses;
    std::vector<std::string> files;
    for (const View& view : views) {
      files.push_back(view.image.lexically_relative(images).generic_string());
      ++uses[short_name(files.back())];
    }
    for (int i = 0; i < count; ++i) index_.emplace(views[i].name, i);
    for (int i = 0; i < count; ++i) {  // emplace: a view name is never displaced by another view's file name
      index_.emplace(files[i], i);
      if (uses[short_name(files[i])] == 1) index_.emplace(short_name(files[i]), i);
    }
  }

  std::vector<int> resolve(const std::vector<std::string>& names, const char* list, const fs::path& path) const {
    std::set<int> found;
    std::string unknown;
    int unknown_count = 0;
    for (const std::string& name : names) {
      const auto entry = index_.find(name);
      if (entry != index_.end()) {
        found.insert(entry->second);
      } else if (++unknown_count <= 20) {  // enough to see the pattern
        unknown += (unknown.empty() ? "" : ", ") + name.substr(0, 100);
      }
    }
    if (unknown_count > 0) {
      throw_bad_input(path, list,
                      std::to_string(unknown_count) + " names are no registered images: " + unknown +
                          (unknown_count > 20 ? ", ..." : ""),
                      "remove them from the list, or register the images");
    }
    return {found.begin(), found.end()};
  }

 private:
  std::map<std::string, int> index_;
};

void read_split(const fs::path& path, const SceneOptions& options, Scene& scene) {
  const int count = static_cast<int>(scene.views.size());
  const SplitJson split = read_split_json(path);
  if (!split.train && !split.test) {
    for (int i = 0; i < count; ++i) {
      const bool test = options.default_test_every > 0 && count > 1 && i % options.default_test_every == 0;
      (test ? scene.test : scene.train).push_back(i);
    }
  } else {
    const ViewNames names(scene.views, scene.folder / "images");
    if (split.test) scene.test = names.resolve(*split.test, "test", path);
    if (split.train) {
      scene.train = names.resolve(*split.train, "train", path);
    } else {  // only the test views are named, as in the published layout: the others are for training
      for (int i = 0; i < count; ++i) {
        if (!std::binary_search(scene.test.begin(), scene.test.end(), i)) scene.train.push_back(i);
      }
    }
    std::vector<int> both;
    std::set_intersection(scene.train.begin(), scene.train.end(), scene.test.begin(), scene.test.end(),
                          std::back_inserter(both));
    if (!both.empty()) {
      throw_bad_input(path, "train, test", "'" + scene.views[both[0]].name + "' is in both lists",
                      "leave each view in one of the lists");
    }
  }
  if (scene.train.empty()) {
    throw_bad_input(path, "train", "no training view is left", "name at least one training view");
  }
}

void read_exposure(const fs::path& path, Scene& scene) {
  ExposureJson gains = read_exposure_json(path);
  for (View& view : scene.views) {
    const auto found = gains.find(view.name);
    if (found == gains.end()) continue;
    view.log_gain = found->second;
    gains.erase(found);
  }
  if (gains.empty()) return;
  throw_bad_input(path, "log_gains", "there is no view '" + gains.begin()->first + "'", "name views of this scene, or remove the entry");
}

bool all_have(const Scene& scene, fs::path View::*map) {
  return !scene.train.empty() &&
         std::all_of(scene.train.begin(), scene.train.end(), [&](int i) { return !(scene.views[i].*map).empty(); });
}

}  // namespace

bool Scene::has_prior_depth() const { return all_have(*this, &View::prior_depth); }
bool Scene::has_network_depth() const { return has_prior_depth() && prior_source != kSensorDepth && prior_source != kStereoDepth; }

bool Scene::has_semantics() const { return all_have(*this, &View::semantics); }

Scene open_scene(const fs::path& given_folder, const SceneOptions& options) {
  const fs::path folder = fs::absolute(given_folder).lexically_normal();
  if (!fs::is_directory(folder)) {
    throw_bad_input(folder, "", "this is no folder", "give the folder of a scene (images/ and sparse/)");
  }
  Scene scene;
  scene.folder = folder;
  const SceneJson description = read_scene_json(folder / "scene.json");
  scene.metric = description.metric;
  scene.up = description.up;
  scene.source = description.source;
  const PriorsJson priors = read_priors_json(folder / "priors.json");
  if (priors.depth) scene.prior_source = priors.depth->model;
  if (priors.semantics) scene.semantic_source = priors.semantics->model;
  scene.semantic_kind = priors.kind.value_or(SemanticKind::kLogits);
  scene.semantic_kind_stated = priors.kind.has_value();
  const fs::path labels = folder / "labels.csv";
  scene.labels = fs::exists(labels) ? read_label_csv(labels) : ade20k_labels();

  if (fs::exists(folder / "transforms.json") && !may_hold_colmap_model(folder)) {
    throw_bad_input(folder, "transforms.json", "this is a nerfstudio data set, not a scene yet",
                    "turn it into one first: aligngs import " + given_folder.string() + " -o SCENE");
  }
  const fs::path model_folder = find_colmap_folder(folder);
  const ColmapModel model = read_colmap_model(model_folder);
  if (model.images.empty()) {
    throw_bad_input(model_folder, "images", "no image is registered", "estimate poses first with `aligngs poses`");
  }
  scene.views = views_of(model, folder, model_folder);
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
  if (options.check_headers) require_good_headers(scene);
  return scene;
}

}  // namespace aligngs
