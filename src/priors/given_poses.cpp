#include "priors/given_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture.h"
#include "scene/import/transforms_place.h"
#include "scene/photo_lookup.h"
#include "scene/photo_places.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

bool has_cameras(const fs::path& folder) { return may_hold_transforms(folder) || may_hold_colmap_model(folder); }

Capture read_cameras(const fs::path& given, const fs::path& photos) {
  const bool file = fs::is_regular_file(given);
  const fs::path folder = file ? fs::absolute(given).parent_path() : given;
  const PhotoLookup lookup(photos, folder);
  return file || may_hold_transforms(folder) ? read_transforms(folder, lookup) : read_colmap_capture(folder, lookup);
}

}  // namespace

fs::path find_given_cameras(const fs::path& photos, const fs::path& given) {
  if (!given.empty()) {
    const bool file = given.filename() == "transforms.json" && fs::is_regular_file(given);
    if (file || has_cameras(given)) return given;
    const bool of_model = given.stem() == "cameras" || given.stem() == "images" || given.stem() == "points3D";
    if (of_model && fs::is_regular_file(given) && may_hold_colmap_model(given.parent_path()))
      return fs::absolute(given).parent_path();
    throw_bad_input(given, "--cameras", "there are no cameras here",
                    "give a COLMAP model (sparse/, cameras.bin or cameras.txt) or a transforms.json");
  }
  const fs::path folder = fs::absolute(photos).lexically_normal() / "";
  const fs::path above = folder.parent_path().parent_path();
  for (const fs::path& place : {folder.parent_path(), above}) {
    if (!has_cameras(place)) continue;
    if (fits_other_cameras(folder.parent_path()) && !transforms_place(place, folder.parent_path()).undistorted)
      throw_bad_input(photos, "--method given", "these photos are undistorted, and the cameras beside them are not",
                      "give resized_images/, or say where their cameras are with --cameras");
    return place;
  }
  throw_bad_input(photos, "--method given", fmt::format("no cameras are here or in {}", above.string()),
                  "put sparse/ (COLMAP) or transforms.json beside the photos, or say where with --cameras");
}

bool has_given_cameras(const fs::path& photos) {
  try {
    return !find_given_cameras(photos, {}).empty();
  } catch (const Error&) {
    return false;
  }
}

GivenPoses read_given_poses(const fs::path& cameras, const fs::path& photos, const std::vector<Photo>& listed) {
  GivenPoses poses;
  poses.capture = read_cameras(cameras, photos);
  std::map<std::string, LeftOut> reasons;  // of cameras that cannot be used, by the name of the view
  size_t without_photo = 0;
  for (const LeftOut& frame : poses.capture.left_out) {
    without_photo += frame.reason == PhotoLookup::kMissing;
    reasons.emplace(view_name_of(frame.name), frame);
  }
  poses.capture.left_out.clear();
  if (without_photo > 0)
    poses.capture.notes.push_back(fmt::format("{} of the given cameras have no photo here", without_photo));
  if (!poses.capture.frames.empty()) finish_capture(poses.capture);
  for (const LeftOut& frame : poses.capture.left_out) reasons.emplace(frame.name, frame);
  poses.capture.left_out.clear();

  std::map<fs::path, const CapturedFrame*> placed;
  std::set<std::string> placed_names;
  for (const CapturedFrame& frame : poses.capture.frames) {
    placed.emplace(fs::weakly_canonical(frame.image), &frame);
    placed_names.insert(view_name_of(fs::path(frame.image).lexically_relative(photos).generic_string()));
  }
  for (const Photo& photo : listed) {
    if (placed.erase(fs::weakly_canonical(photo.file)) > 0) {
      poses.photos.push_back(photo);
      continue;
    }
    if (placed_names.count(photo.name)) continue;  // the cameras are for its namesake with another extension
    poses.photos.push_back(photo);
    const std::string ending = fs::path(photo.name).filename().string();
    const auto known = std::find_if(reasons.begin(), reasons.end(), [&](const auto& entry) {
      return entry.first == photo.name || fs::path(entry.first).filename().string() == ending;
    });
    const bool told = known != reasons.end() && known->second.reason != PhotoLookup::kMissing;
    poses.unplaced.push_back({photo.name, told ? known->second.reason : "the given cameras hold none for it",
                              told ? known->second.remedy : ""});
  }
  for (const auto& [file, frame] : placed) {
    const ImageInfo info = read_image_info(frame->image);
    poses.photos.push_back({frame->name, frame->image, info.width, info.height});
  }
  return poses;
}

}  // namespace aligngs
