#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/log.h"
#include "io/colmap.h"
#include "io/output_place.h"
#include "scene/lens_model.h"
#include "scene/mesh_ply.h"
#include "scene/not_a_scene.h"
#include "scene/photo_fit.h"
#include "scene/photo_lookup.h"
#include "scene/photo_mask.h"
#include "scene/scene_check.h"
#include "scene/scene_json.h"
#include "scene/view_names.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// "left/0001.color.png" has the view name "left/0001.color" (up to the last dot) and the short name "left/0001" (up to
/// the first dot of the file).
std::string short_name(const std::string& image_name) {
  const fs::path path(image_name);
  const std::string file = path.filename().string();
  return (path.parent_path() / file.substr(0, file.find('.', 1))).generic_string();
}

void require_inside_folder(const std::string& image_name, const fs::path& path) {
  const fs::path name(slashed_name(image_name));
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
  explicit MapNames(const std::vector<std::string>& image_names) {
    for (const std::string& name : image_names) ++uses_[short_name(name)];
  }

  /// The first existing <folder>/<stem><extension>; empty when there is none. Error{kBadInput} where the first stem
  /// that has a file has several: nobody could tell which one is meant.
  fs::path find(const fs::path& folder, const std::string& image_name,
                std::initializer_list<const char*> extensions) const {
    std::vector<std::string> stems = {view_name_of(image_name)};
    const fs::path as_written(slashed_name(image_name));
    stems.push_back((as_written.parent_path() / as_written.stem()).generic_string());  // a name that is no UTF-8
    const std::string brief = short_name(image_name);
    if (uses_.at(brief) == 1) stems.push_back(brief);
    for (const std::string& stem : stems) {
      fs::path found;
      for (const char* extension : extensions) {
        fs::path path = folder / (stem + extension);
        if (!fs::is_regular_file(path)) continue;
        if (!found.empty()) {
          throw_bad_input(path, "map", "the view has " + found.filename().string() + " as well",
                          "remove one of the two");
        }
        found = std::move(path);
      }
      if (!found.empty()) return found;
    }
    return {};
  }

 private:
  std::map<std::string, int> uses_;
};

/// The lenses of a model by camera id.
class Lenses {
 public:
  /// Error{kBadInput} where a lens bends rays: that is no matter of single views.
  Lenses(const ColmapModel& model, const fs::path& folder) : path_(folder / "cameras") {
    for (const ColmapCamera& camera : model.cameras) {
      cameras_[camera.id] = &camera;
      std::vector<LeftOut> unusable;  // said for each view that has it
      use_or_leave_out(camera.model, unusable, [&] { lenses_[camera.id] = lens_of(camera, path_); });
    }
    for (const auto& [id, lens] : lenses_) {
      if (!lens.distorted()) continue;
      throw_bad_input(path_, "camera " + std::to_string(id),
                      "the lens distortion of this camera model is not removed from the images",
                      "make an undistorted scene of it with `aligngs import`");
    }
  }
  /// Error{kBadInput} where its camera model is none of ours.
  Camera pinhole(const ColmapImage& image) const {
    const auto found = lenses_.find(image.camera_id);
    Camera camera = (found != lenses_.end() ? found->second : lens_of(*cameras_.at(image.camera_id), path_)).pinhole();
    camera.world_to_camera = {rotation_matrix(normalized(image.rotation)), image.translation};
    return camera;
  }

 private:
  fs::path path_;
  std::map<uint32_t, const ColmapCamera*> cameras_;
  std::map<uint32_t, LensModel> lenses_;
};

/// True cameras by view name.
std::map<std::string, Camera> cameras_of(const ColmapModel& model, const fs::path& folder) {
  const Lenses lenses(model, folder);
  std::map<std::string, Camera> cameras;
  for (const ColmapImage& image : model.images) cameras.emplace(view_name_of(image.name), lenses.pinhole(image));
  return cameras;
}

/// The names of a model's images. Absolute ones are paths of another machine: they become relative together.
std::vector<std::string> relative_names(const ColmapModel& model) {
  std::vector<std::string> names;
  for (const ColmapImage& image : model.images) names.push_back(image.name);
  return std::any_of(names.begin(), names.end(), is_absolute_name) ? without_shared_folders(names) : names;
}

/// Finds the photo of a view and brings the camera to its size. A photo that is missing keeps the place where it should
/// be, for the check of headers to report.
void pair_with_photo(const PhotoLookup& photos, const ColmapImage& image, const std::string& name,
                     const fs::path& images, View& view) {
  PhotoLookup::Answer answer = photos.find(image.name);
  if (name != image.name && !lies_within(answer.file, images.parent_path())) answer = photos.find(name);
  view.image = answer.file.empty() ? images / name : answer.file;
  if (answer.file.empty()) {
    if (photos.is_ambiguous(answer))
      throw_bad_input(view.image, "image", answer.problem, "rename or remove the others");
    return;
  }
  std::optional<PhotoFit> fit;
  try {
    fit = fit_photo(read_image_info(view.image), view.camera.width, view.camera.height);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    return;  // the check of headers reports it
  }
  if (fit) view.camera = view.camera.resized(fit->width, fit->height);
}

/// Two cameras for one photo: neither can be trusted.
void leave_out_shared_photos(std::vector<View>& views, std::vector<LeftOut>& left_out) {
  std::map<fs::path, int> uses;
  for (const View& view : views) ++uses[view.image];
  std::erase_if(views, [&](const View& view) {
    if (uses[view.image] == 1) return false;
    left_out.push_back(
        {view.name, "several cameras name the photo " + view.image.filename().string(), "give each photo one camera"});
    return true;
  });
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
  const PointCloud with_normals = read_cloud_file(ply).cloud;
  if (!with_normals.has_normals() || with_normals.size() != cloud.size()) return cloud;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (norm(with_normals.positions[i] - cloud.positions[i]) > 1e-5f * (1 + norm(cloud.positions[i]))) return cloud;
  }
  cloud.normals = with_normals.normals;
  return cloud;
}

std::vector<View> views_of(const ColmapModel& model, const fs::path& folder, const fs::path& model_folder,
                           std::vector<LeftOut>& left_out) {
  const Lenses lenses(model, model_folder);
  std::map<std::string, Camera> truth;
  if (fs::is_directory(folder / "truth" / "sparse")) {
    const fs::path truth_folder = find_colmap_folder(folder / "truth");
    truth = cameras_of(read_colmap_model(truth_folder), truth_folder);
  }
  const std::vector<std::string> image_names = relative_names(model);
  const MapNames maps(image_names);
  const PhotoLookup photos = photos_of_data_set(folder);
  std::vector<View> views;
  std::set<std::string> names;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const ColmapImage& image = model.images[i];
    const std::string& name = image_names[i];
    View view;
    view.name = view_name_of(name);
    const auto pair = [&] {
      require_inside_folder(name, model_folder / "images");
      if (!names.insert(view.name).second) {
        throw_bad_input(model_folder / "images", "image '" + image.name + "'",
                        "two images have the name '" + view.name + "' before the last dot",
                        "rename one of them: maps are found by that name");
      }
      view.camera = lenses.pinhole(image);
      pair_with_photo(photos, image, name, folder / "images", view);
    };
    if (!use_or_leave_out(view.name, left_out, pair)) continue;
    view.mask = find_mask(view.image);
    view.prior_depth = maps.find(folder / "pred_depths", name, {".npy"});
    view.semantics = maps.find(folder / "segmentation_logits", name, {".npz", ".npy", ".pt", ".pth"});
    view.truth_depth = maps.find(folder / "truth" / "depth", name, {".png"});
    view.truth_labels = maps.find(folder / "truth" / "labels", name, {".png"});
    if (const auto found = truth.find(view.name); found != truth.end()) {
      view.truth_camera = found->second.resized(view.camera.width, view.camera.height);
    }
    views.push_back(std::move(view));
  }
  leave_out_shared_photos(views, left_out);
  std::sort(views.begin(), views.end(), [](const View& a, const View& b) { return a.name < b.name; });
  return views;
}

/// Resolves the names of split.json: view names, short names or file names.
class ViewNames {
 public:
  /// `left_out`: names that mean views which cannot be used; they resolve to nothing.
  ViewNames(const std::vector<View>& views, const fs::path& images, const std::vector<LeftOut>& left_out) {
    for (const LeftOut& view : left_out) {
      left_out_.insert({view.name, view_name_of(view.name)});
      reasons_ += "; left out: " + view.name.substr(0, 100) + " (" + view.reason + ")";
    }
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
      } else if (left_out_.count(name) || left_out_.count(view_name_of(name))) {
        continue;
      } else if (++unknown_count <= 20) {  // enough to see the pattern
        unknown += (unknown.empty() ? "" : ", ") + name.substr(0, 100);
      }
    }
    if (unknown_count > 0) {
      throw_bad_input(path, list,
                      std::to_string(unknown_count) + " names are no registered images: " + unknown +
                          (unknown_count > 20 ? ", ..." : "") + reasons_,
                      "remove them from the list, or register the images");
    }
    return {found.begin(), found.end()};
  }

 private:
  std::map<std::string, int> index_;
  std::set<std::string> left_out_;
  std::string reasons_;  ///< of what is left out: one of the unknown names may have meant it
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
    const ViewNames names(scene.views, scene.folder / "images", scene.left_out);
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
  if (split.train) {  // what no list names is not missed
    std::set<std::string> named(split.train->begin(), split.train->end());
    if (split.test) named.insert(split.test->begin(), split.test->end());
    std::erase_if(scene.left_out, [&](const LeftOut& view) {
      return !named.count(view.name) && !named.count(view_name_of(view.name));
    });
  }
  require_enough_training_views(scene);
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
  for (const LeftOut& view : scene.left_out) gains.erase(view.name);
  if (gains.empty()) return;
  throw_bad_input(path, "log_gains", "there is no view '" + gains.begin()->first + "'",
                  "name views of this scene, or remove the entry");
}

bool all_have(const Scene& scene, fs::path View::*map) {
  return !scene.train.empty() &&
         std::all_of(scene.train.begin(), scene.train.end(), [&](int i) { return !(scene.views[i].*map).empty(); });
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
  scene.views = views_of(model, folder, model_folder, scene.left_out);
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
