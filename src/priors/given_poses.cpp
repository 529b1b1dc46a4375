#include "priors/given_poses.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "core/error.h"
#include "core/log.h"
#include "scene/undistort.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// A model's cameras and points; unlike read_colmap_capture() it does not look for the images.
Capture capture_of_model(const fs::path& folder) {
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kColmap);
  capture.folder = folder;
  const ColmapModel model = read_colmap_model(find_colmap_folder(folder));
  capture.frames = frames_of_model(model);
  capture.cloud = reliable_points(model);
  if (capture.cloud.size() == 0 && !model.points.empty()) {
    log_warning("{}: all {} points are left out, as their reprojection errors are above 2 pixels", folder.string(), model.points.size());
  }
  return capture;
}

/// The camera for the photo's copy.
ColmapCamera camera_for(const CapturedFrame& frame, const Photo& listed, const Photo& prepared) {
  const LensModel lens = lens_of(frame.camera, listed.file);
  const double scale = double(listed.width) / lens.width;
  if (std::abs(lens.height * scale - listed.height) > 1) {
    const bool turned = std::abs(double(listed.height) / lens.width * lens.height - listed.width) <= 1;
    throw_bad_input(listed.file, "camera",
                    fmt::format("the camera is for {} x {} pixels, the photo has {} x {}", lens.width,
                                lens.height, listed.width, listed.height),
                    turned ? "the camera is for the picture before it is turned upright: turn the photos "
                             "themselves (exiftran, jhead), then find the cameras again"
                           : "give the photos that the cameras were found for");
  }
  return colmap_camera_of(lens.resized(prepared.width, prepared.height));
}

}  // namespace

fs::path find_given_cameras(const fs::path& photos, const fs::path& given) {
  if (!given.empty()) {
    const bool file = given.filename() == "transforms.json" && fs::is_regular_file(given);
    if (file || fs::exists(given / "transforms.json") || may_hold_colmap_model(given)) return given;
    throw_bad_input(given, "--cameras", "there are no cameras here",
                    "give a COLMAP model (sparse/, cameras.bin or cameras.txt) or a transforms.json");
  }
  const fs::path folder = fs::absolute(photos).lexically_normal() / "";
  const fs::path above = folder.parent_path().parent_path();
  for (const fs::path& place : {folder.parent_path(), above}) {
    if (fs::exists(place / "transforms.json") || may_hold_colmap_model(place)) return place;
  }
  throw_bad_input(photos, "--method given",
                  fmt::format("no cameras are here or in {}", above.string()),
                  "put sparse/ (COLMAP) or transforms.json beside the photos, or say where with --cameras");
}

GivenPoses read_given_poses(const fs::path& cameras, const std::vector<Photo>& listed,
                            const std::vector<Photo>& prepared) {
  GivenPoses poses;
  if (cameras.filename() == "transforms.json") {
    poses.capture = read_transforms(cameras.parent_path());
  } else if (fs::exists(cameras / "transforms.json")) {
    poses.capture = read_transforms(cameras);
  } else {
    poses.capture = capture_of_model(cameras);
  }
  std::map<std::string, CapturedFrame> frames;
  for (CapturedFrame& frame : poses.capture.frames) {
    const std::string name = frame.name;
    if (!frames.emplace(name, std::move(frame)).second) {
      throw_bad_input(cameras, name, "two cameras are for photos of this name",
                      "photos in subfolders need names of their own");
    }
  }
  poses.capture.frames.clear();
  for (size_t i = 0; i < listed.size(); ++i) {
    const auto found = frames.find(listed[i].name);
    if (found == frames.end()) {
      poses.unplaced.push_back({listed[i].name, "the given cameras hold none for it"});
      continue;
    }
    CapturedFrame frame = std::move(found->second);
    frame.camera = camera_for(frame, listed[i], prepared[i]);
    frame.image = prepared[i].file;
    poses.capture.frames.push_back(std::move(frame));
  }
  return poses;
}

}  // namespace aligngs
