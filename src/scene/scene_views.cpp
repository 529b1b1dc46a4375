#include "scene/scene_views.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/error.h"
#include "io/output_place.h"
#include "scene/lens_model.h"
#include "scene/map_names.h"
#include "scene/photo_fit.h"
#include "scene/photo_lookup.h"
#include "scene/photo_mask.h"
#include "scene/view_names.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

void require_inside_folder(const std::string& image_name, const fs::path& path) {
  const fs::path name(slashed_name(image_name));
  bool inside = !image_name.empty() && name.is_relative() && !name.filename().empty();
  for (const fs::path& part : name) inside = inside && part != "..";
  if (!inside) {
    throw_bad_input(path, "image '" + image_name.substr(0, 200) + "'", "the name points outside of images/",
                    "write image names relative to the folder images/");
  }
}

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

}  // namespace

std::vector<View> read_views(const ColmapModel& model, const fs::path& folder, const fs::path& model_folder,
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

}  // namespace aligngs
