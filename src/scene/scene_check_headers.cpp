// Headers and the presence of files: the first part of scene_check.h.
#include <algorithm>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/prior_maps.h"
#include "scene/scene_check.h"

namespace aligngs {
namespace {

/// Runs a check that throws and notes its error as a problem.
template <class Check>
void note_error(std::vector<SceneProblem>& problems, const std::filesystem::path& path, Check check) {
  try {
    check();
  } catch (const Error& error) {
    const Error::Details& d = error.details();
    problems.push_back({d.path.empty() ? path : d.path, d.field, d.message, d.remedy, true});
  }
}

void check_image_header(const View& view) {
  if (!std::filesystem::is_regular_file(view.image)) {
    throw_bad_input(view.image, "image", "a registered image is missing",
                    "put the image there, or leave the view out of split.json");
  }
  const ImageInfo info = read_image_info(view.image);
  if (info.width == view.camera.width && info.height == view.camera.height) return;
  throw_bad_input(view.image, "size",
                  "the image is " + std::to_string(info.width) + " x " + std::to_string(info.height) +
                      ", its camera says " + std::to_string(view.camera.width) + " x " +
                      std::to_string(view.camera.height),
                  "use the images that the camera model was made from (after their EXIF rotation)");
}

/// A map that training view `view` lacks although others have it.
SceneProblem missing_map(const Scene& scene, const View& view, const char* folder, size_t present) {
  return {scene.folder / folder / (view.name + ".npy"), "map",
          "missing, although " + std::to_string(present) + " of " + std::to_string(scene.train.size()) +
              " training views have one",
          std::string("add the map, or remove the folder ") + folder + " to train without this prior", true};
}

size_t count_present(const Scene& scene, std::filesystem::path View::*map) {
  return static_cast<size_t>(
      std::count_if(scene.train.begin(), scene.train.end(), [&](int i) { return !(scene.views[i].*map).empty(); }));
}

}  // namespace

std::vector<SceneProblem> check_headers(const Scene& scene) {
  std::vector<SceneProblem> problems;
  std::vector<int> used = scene.train;
  used.insert(used.end(), scene.test.begin(), scene.test.end());
  std::sort(used.begin(), used.end());
  for (int i : used) {
    const View& view = scene.views[i];
    note_error(problems, view.image, [&] { check_image_header(view); });
    if (!view.prior_depth.empty()) note_error(problems, view.prior_depth, [&] { check_depth_header(view); });
    if (!view.semantics.empty()) {
      note_error(problems, view.semantics, [&] { check_semantic_header(view, scene.labels); });
    }
  }
  const size_t depths = count_present(scene, &View::prior_depth), semantics = count_present(scene, &View::semantics);
  for (int i : scene.train) {
    const View& view = scene.views[i];
    if (depths > 0 && view.prior_depth.empty()) problems.push_back(missing_map(scene, view, "pred_depths", depths));
    if (semantics > 0 && view.semantics.empty()) {
      problems.push_back(missing_map(scene, view, "segmentation_logits", semantics));
    }
  }
  return problems;
}

void require_good_headers(const Scene& scene) {
  const std::vector<SceneProblem> problems = check_headers(scene);
  if (problems.empty()) return;
  const SceneProblem& first = problems.front();
  std::string message = first.message;
  if (problems.size() > 1) {
    message += " (and " + std::to_string(problems.size() - 1) + " more problems: `aligngs data check` lists them)";
  }
  throw_bad_input(first.path, first.field, message, first.remedy);
}

}  // namespace aligngs
