// A COLMAP reconstruction and its photos. The model (bin or txt) is in sparse/[N/], colmap/sparse/[N/] or the folder
// itself. Photos are in images/, in the folder or in a subfolder of it (photo_lookup.h). Rigs and frames are not
// needed: images.bin has every pose.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/error.h"
#include "io/picture_format.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/photo_places.h"
#include "scene/view_names.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// The data set around a model that was given alone, as one of several beside the photos. Empty where the data set
/// names its model by itself.
fs::path data_set_of_several(const fs::path& folder) {
  const fs::path around = images_folder(folder).empty() ? data_set_around(folder) : fs::path();
  return around.empty() || may_hold_colmap_model(around) ? fs::path() : around;
}

/// Photos beside those of the model that it has no camera for.
void note_photos_without_camera(Capture& capture) {
  std::set<fs::path> folders, known;
  for (const CapturedFrame& frame : capture.frames) {
    folders.insert(frame.image.parent_path());
    known.insert(frame.image);
  }
  std::set<std::string> named;
  for (const LeftOut& frame : capture.left_out) named.insert(view_name_of(frame.name));
  std::vector<std::string> without;
  for (const fs::path& folder : folders) {
    for (const fs::path& photo : list_files(folder, picture_extensions())) {
      const std::string name = photo.filename().string();
      if (!known.count(photo) && !named.count(view_name_of(name)) && !is_hidden(photo))
        without.push_back(as_utf8(name));
    }
  }
  if (without.empty()) return;
  constexpr size_t kShown = 5;
  const size_t shown = std::min(kShown, without.size());
  capture.notes.push_back(
      fmt::format("{} without a camera in the model: {}{}",
                  without.size() == 1 ? "1 photo is" : fmt::format("{} photos are", without.size()),
                  fmt::join(without.begin(), without.begin() + shown, ", "),
                  without.size() > shown ? fmt::format(" and {} more", without.size() - shown) : ""));
}

Capture read_with_photos(const fs::path& folder) {
  Capture capture = read_colmap_capture(folder, photos_of_data_set(folder));
  const fs::path around = capture.frames.empty() ? data_set_of_several(folder) : fs::path();
  if (around.empty()) return capture;
  capture = read_colmap_capture(folder, PhotoLookup(images_folder(around), around));
  capture.notes.push_back("the photos are those of " + around.string());
  return capture;
}

}  // namespace

Capture read_colmap_capture(const fs::path& folder, const CaptureOptions&) {
  Capture capture = read_with_photos(folder);
  note_photos_without_camera(capture);
  return capture;
}

Capture read_colmap_capture(const fs::path& folder, const PhotoLookup& photos) {
  Capture capture;
  capture.layout = "colmap";
  capture.folder = folder;
  const fs::path model_folder = find_colmap_folder(folder);
  const fs::path camera_file = first_existing({model_folder / "cameras.bin", model_folder / "cameras.txt"});
  const ColmapModel model = read_colmap_model(model_folder);
  capture.left_out = model.left_out;
  if (const std::string choice = choice_of_model(folder); !choice.empty()) capture.notes.push_back(choice);
  if (model.points_left_out > 0) capture.notes.push_back(note_of_unusable_points(model.points_left_out));
  std::map<uint32_t, const ColmapCamera*> cameras;
  for (const ColmapCamera& camera : model.cameras) cameras[camera.id] = &camera;
  for (const ColmapImage& image : model.images) {
    add_frame(capture, image.name, [&] {
      CapturedFrame frame;
      frame.name = slashed_name(image.name);
      const PhotoLookup::Answer photo = photos.find(image.name);
      if (photo.file.empty()) throw_bad_input({}, "", photo.problem, missing_photos_remedy(folder));
      frame.image = photo.file;
      set_camera(frame, *cameras.at(image.camera_id), camera_file);
      frame.world_to_camera = {rotation_matrix(normalized(image.rotation)), image.translation};
      return frame;
    });
  }
  const bool plain = std::none_of(capture.frames.begin(), capture.frames.end(),
                                  [](const CapturedFrame& frame) { return leads_elsewhere(frame.name); });
  if (!plain) shorten_names(capture);
  for (CapturedFrame& frame : capture.frames) {
    if (plain) frame.name = view_name_of(frame.name);
  }
  std::sort(capture.frames.begin(), capture.frames.end(),
            [](const CapturedFrame& a, const CapturedFrame& b) { return natural_less(a.name, b.name); });
  constexpr double kMaxError = 2;  // pixels; what 3DGS' readers keep
  size_t inexact = 0;
  for (const ColmapPoint& point : model.points) {
    if (point.error > kMaxError) {
      ++inexact;
      continue;
    }
    capture.cloud.positions.push_back(point.position);
    capture.cloud.colors.push_back({point.color[0] / 255.f, point.color[1] / 255.f, point.color[2] / 255.f});
  }
  if (2 * inexact > model.points.size()) {
    capture.notes.push_back(std::to_string(inexact) + " of " + std::to_string(model.points.size()) +
                            " points have an error above 2 pixels and are not used");
  }
  return capture;
}

}  // namespace aligngs
