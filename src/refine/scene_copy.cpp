#include "refine/scene_copy.h"

#include "core/error.h"
#include "io/file_system_error.h"
#include "io/folder_copy.h"
#include "io/folder_replacement.h"
#include "scene/colmap_model.h"
#include "scene/scene_json.h"
#include "scene/scene_place.h"

namespace aligngs {

namespace fs = std::filesystem;

void copy_scene(const fs::path& from, const fs::path& to) {
  std::error_code error;
  copy_folder(from, to, CopiedLinks::kFollowed, error);
  if (error) throw_resources(to, "the scene cannot be copied: " + error.message(), remedy_for_write(error.value()));
}

void write_used_split(const Scene& scene, const fs::path& folder) {
  if (scene.left_out.empty()) return;
  SplitJson split;
  split.train.emplace();
  split.test.emplace();
  for (const int i : scene.train) split.train->push_back(scene.views[static_cast<size_t>(i)].name);
  for (const int i : scene.test) split.test->push_back(scene.views[static_cast<size_t>(i)].name);
  write_split_json(folder / "split.json", split);
}

void write_scene_copy(const fs::path& from, const fs::path& to, bool overwrite) {
  require_scene_place(to, overwrite, {from});
  FolderReplacement replacement(to);
  copy_scene(from, replacement.path());
  mark_as_own(replacement.path());
  place_scene(replacement, overwrite, {from});
}

void write_scene_cameras(const Scene& scene, const std::vector<Camera>& cameras, const fs::path& folder) {
  ColmapModel model;
  for (size_t i = 0; i < scene.views.size(); ++i) append_view(model, cameras[i], image_name_of(scene, scene.views[i]));
  append_points(model, scene.cloud);
  fs::remove_all(folder / "sparse");
  write_colmap_binary(folder / "sparse", model);
}

void write_training_exposure(const Scene& scene, const std::vector<Vec3f>& log_gains, const fs::path& folder) {
  ExposureJson exposure;
  for (size_t i = 0; i < log_gains.size(); ++i)
    exposure[scene.views[static_cast<size_t>(scene.train[i])].name] = log_gains[i];
  write_exposure_json(folder / "exposure.json", exposure);
}

}  // namespace aligngs
