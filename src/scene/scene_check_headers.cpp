// Headers and the presence of files: the first part of scene_check.h.
#include <algorithm>
#include <set>

#include "core/error.h"
#include "io/file_system_error.h"
#include "io/image_file.h"
#include "scene/photo_fit.h"
#include "scene/photo_places.h"
#include "scene/prior_maps.h"
#include "scene/scene_check.h"
#include "scene/segment_file.h"

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
  } catch (const std::filesystem::filesystem_error& failed) {
    const Error error = error_of(failed);
    if (error.kind() != ErrorKind::kBadInput) throw;
    problems.push_back({path, {}, error.details().message, error.details().remedy, true});
  }
}

void check_image_header(const View& view, const std::filesystem::path& folder) {
  if (!std::filesystem::is_regular_file(view.image)) {
    const bool elsewhere = images_folder(folder).empty() && !data_set_around(folder).empty();
    throw_bad_input(
        view.image, "image", "a registered image is missing",
        elsewhere ? missing_photos_remedy(folder) : "put the image there, or leave the view out of split.json");
  }
  const ImageInfo info = read_image_info(view.image);
  require_whole_picture(view.image);
  const bool fits = (info.stored_width == view.camera.width && info.stored_height == view.camera.height) ||
                    (info.width == view.camera.width && info.height == view.camera.height);
  if (!fits) require_photo_fit(view.image, info, view.camera.width, view.camera.height);
}

/// A map that training view `view` lacks although others have it.
SceneProblem missing_map(const Scene& scene, const View& view, const char* folder, size_t present) {
  return {scene.folder / folder / (view.name + ".npy"),
          "map",
          "missing, although " + std::to_string(present) + " of " + std::to_string(scene.train.size()) +
              " training views have one",
          std::string("add the map, or remove the folder ") + folder + " to train without this prior",
          true,
          view.name};
}

std::filesystem::path confidence_of(const Scene& scene, const View& view) {
  return scene.folder / "pred_confidence" / (view.name + ".npy");
}

void check_confidence_header(const Scene& scene, const View& view) {
  const std::filesystem::path path = confidence_of(scene, view);
  if (!std::filesystem::exists(path)) return;
  require_same_aspect(depth_map_shape(read_map_header(path).shape, path), view.camera.width, view.camera.height, path,
                      "shape");
}

/// Views without a map are left out when most training views have it. `few`: what happens to maps that few have.
template <class HasMap>
void check_presence(const Scene& scene, HasMap has_map, const char* folder, std::vector<SceneProblem>& problems,
                    const char* few = "none is used") {
  const auto has = [&](int i) { return has_map(scene.views[i]); };
  const size_t present = static_cast<size_t>(std::count_if(scene.train.begin(), scene.train.end(), has)),
               all = scene.train.size();
  if (present == 0 || present == all) return;
  if (2 * present < all) {
    problems.push_back(
        {scene.folder / folder, "map",
         "only " + std::to_string(present) + " of " + std::to_string(all) + " training views have one: " + few,
         "make the map for every training view", false});
    return;
  }
  for (const int i : scene.train) {
    if (!has(i)) problems.push_back(missing_map(scene, scene.views[i], folder, present));
  }
}

/// Segments of some views are of no use, and no reason to leave the others out.
void check_segment_presence(const Scene& scene, std::vector<SceneProblem>& problems) {
  const auto has = [&](int i) { return std::filesystem::is_regular_file(segment_file_of(scene, scene.views[i])); };
  const auto present = static_cast<size_t>(std::count_if(scene.train.begin(), scene.train.end(), has));
  if (present == 0 || present == scene.train.size()) return;
  problems.push_back({scene.folder / "segments", "map",
                      "only " + std::to_string(present) + " of " + std::to_string(scene.train.size()) +
                          " training views have one: none is used",
                      "make the segments of every training view", false});
}

}  // namespace

std::vector<SceneProblem> check_headers(const Scene& scene) {
  std::vector<SceneProblem> problems;
  std::vector<int> used = scene.train;
  used.insert(used.end(), scene.test.begin(), scene.test.end());
  std::sort(used.begin(), used.end());
  for (int i : used) {
    const View& view = scene.views[i];
    const size_t before = problems.size();
    note_error(problems, view.image, [&] { check_image_header(view, scene.folder); });
    if (!view.prior_depth.empty()) note_error(problems, view.prior_depth, [&] { check_depth_header(view); });
    if (!view.semantics.empty()) {
      note_error(problems, view.semantics, [&] { check_semantic_header(view, scene.labels); });
    }
    note_error(problems, view.image, [&] { check_confidence_header(scene, view); });
    note_error(problems, view.image, [&] { check_segment_header(scene, view); });
    for (size_t k = before; k < problems.size(); ++k) problems[k].view = view.name;
  }
  check_presence(
      scene, [](const View& view) { return !view.prior_depth.empty(); }, "pred_depths", problems);
  check_presence(
      scene, [](const View& view) { return !view.semantics.empty(); }, "segmentation_logits", problems);
  check_presence(
      scene, [&](const View& view) { return std::filesystem::exists(confidence_of(scene, view)); }, "pred_confidence",
      problems, "all depth of the others is used");
  check_segment_presence(scene, problems);
  return problems;
}

namespace {

void take_from_lists(Scene& scene, const std::set<std::string>& names) {
  for (std::vector<int>* list : {&scene.train, &scene.test}) {
    std::erase_if(*list, [&](int i) { return names.count(scene.views[i].name) > 0; });
  }
}

}  // namespace

std::vector<SceneProblem> leave_out_bad_views(Scene& scene, const std::vector<SceneProblem>& problems) {
  std::vector<SceneProblem> others;
  std::set<std::string> bad;
  for (const SceneProblem& problem : problems) {
    if (!problem.fatal || problem.view.empty()) {
      others.push_back(problem);
    } else if (bad.insert(problem.view).second) {  // its first problem is its reason
      const Error error({ErrorKind::kBadInput, problem.message, problem.path, problem.field, problem.remedy});
      scene.left_out.push_back(left_out_for(problem.view, error));
    }
  }
  take_from_lists(scene, bad);
  require_enough_training_views(scene);
  return others;
}

void require_enough_training_views(const Scene& scene) {
  const size_t used = scene.train.size() + scene.test.size();
  if (scene.train.size() < kFewestTrainingViews)
    require_enough(scene.folder, used, scene.left_out, used + 1, false, "views");
}

void leave_out_views(Scene& scene, const std::vector<std::string>& names) {
  take_from_lists(scene, {names.begin(), names.end()});
}

}  // namespace aligngs
