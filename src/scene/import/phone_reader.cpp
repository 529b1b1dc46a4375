// Raw captures of LiDAR telephones. A frame has a JSON with intrinsics and a camera-to-world matrix of ARKit (world +y
// up, camera x right, y up, z back, metres). Depth is in millimetres and registered to the photo. A confidence of 0 is
// low.
//
// Polycam, "raw data": keyframes/{corrected_cameras,cameras}/T.json (fx fy cx cy width height t_00 .. t_23),
//   keyframes/{corrected_images,images}/T.jpg, keyframes/depth/T.png, keyframes/confidence/T.png.
// 3D Scanner App, "all data": frame_N.json (intrinsics and cameraPoseARFrame, rows first), frame_N.jpg of some frames,
//   depth_N.png, conf_N.png.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/file_system_error.h"
#include "io/foreign_content.h"
#include "io/image_limits.h"
#include "io/json_text.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/frame_photos.h"
#include "scene/import/json_number.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr const char* kBadFrame = "export the capture again, or leave this frame out";

Json read_frame_json(const fs::path& file) {
  const std::string content = read_file(file);
  Json document = parse_json(text_of_file(content, file));
  if (document.is_discarded()) refuse_foreign_content(content, file);
  if (!document.is_object()) throw_bad_input(file, "", "this is no JSON object", kBadFrame);
  return document;
}

/// NaN for the words "NaN" and "Infinity", as in a pose of lost tracking. Error{kBadInput} naming `field` for other
/// values.
double number_in(const Json& value, const std::string& field, const fs::path& file) {
  if (value.is_number()) return value.get<double>();
  if (!is_number_of_json(value) || std::isfinite(number_of_json(value)))
    throw_bad_input(file, field, no_number(value), kBadFrame);
  return NAN;
}

/// The same of a field, which has to be there.
double number_of(const Json& document, const std::string& key, const fs::path& file) {
  const auto found = document.find(key);
  if (found == document.end()) throw_bad_input(file, key, "the field is missing", kBadFrame);
  return number_in(*found, key, file);
}

std::vector<double> numbers_of(const Json& document, const std::string& key, size_t count, const fs::path& file) {
  const auto found = document.find(key);
  if (found == document.end()) throw_bad_input(file, key, "the field is missing", kBadFrame);
  if (!found->is_array() || found->size() != count)
    throw_bad_input(file, key, "expected " + std::to_string(count) + " numbers", kBadFrame);
  std::vector<double> numbers;
  for (const Json& value : *found)
    numbers.push_back(number_in(value, key + "[" + std::to_string(numbers.size()) + "]", file));
  return numbers;
}

Rigidd pose_of(const std::vector<double>& camera_to_world, const fs::path& file, const char* field) {
  if (!all_finite(camera_to_world.data(), camera_to_world.size()))
    throw_bad_input(file, field, "lost tracking (pose is not finite)", "leave this frame out");
  return opencv_world_to_camera_from_opengl(rigid_from_matrix(camera_to_world, file, field));
}

Capture arkit_capture(const fs::path& folder) {
  Capture capture;
  capture.folder = folder;
  capture.metric = true;
  capture.up = Vec3d{0, 1, 0};
  capture.up_measured = true;
  capture.up_source = "ARKit's convention (+y)";
  return capture;
}

/// The corrected folder where it holds something. Error{kBadInput} where it may not be read.
fs::path better_of(const fs::path& corrected, const fs::path& plain, const std::vector<std::string>& extensions) {
  std::error_code error;
  if (fs::is_directory(corrected, error)) require_readable_folder(corrected, {});
  return list_files(corrected, extensions).empty() ? plain : corrected;
}

CapturedFrame polycam_frame(const fs::path& image, const fs::path& json, const fs::path& keyframes) {
  CapturedFrame frame;
  frame.name = image.stem().string();
  frame.image = image;
  if (!fs::exists(json)) throw_bad_input(json, "", "the camera is missing", "leave this frame out");
  const Json document = read_frame_json(json);
  std::vector<double> matrix;
  for (const char row : {'0', '1', '2'}) {
    for (const char column : {'0', '1', '2', '3'})
      matrix.push_back(number_of(document, std::string("t_") + row + column, json));
  }
  matrix.insert(matrix.end(), {0, 0, 0, 1});
  frame.world_to_camera = pose_of(matrix, json, "t_00 .. t_23");
  ColmapCamera camera;
  camera.model = "PINHOLE";
  const double width = number_of(document, "width", json), height = number_of(document, "height", json);
  if (!(width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide))
    throw_bad_input(json, "width, height", "no size of a photo", "export the capture again");
  camera.width = static_cast<uint64_t>(width);
  camera.height = static_cast<uint64_t>(height);
  for (const char* key : {"fx", "fy", "cx", "cy"}) camera.params.push_back(number_of(document, key, json));
  if (!all_finite(camera.params.data(), camera.params.size()))
    throw_bad_input(json, "fx, fy, cx, cy", "a number is not finite", "export the capture again");
  set_camera(frame, camera, json);
  set_depth(frame, keyframes / "depth" / (frame.name + ".png"));
  frame.confidence = file_if_there(keyframes / "confidence" / (frame.name + ".png"));
  return frame;
}

CapturedFrame scanner_frame(const fs::path& image, const fs::path& folder) {
  CapturedFrame frame;
  frame.name = image.stem().string();
  frame.image = image;
  const fs::path json = folder / (frame.name + ".json");
  if (!fs::exists(json)) throw_bad_input(json, "", "the camera is missing", "leave this frame out");
  const Json document = read_frame_json(json);
  frame.world_to_camera = pose_of(numbers_of(document, "cameraPoseARFrame", 16, json), json, "cameraPoseARFrame");
  const std::vector<double> k = numbers_of(document, "intrinsics", 9, json);
  if (const std::string fault = fault_of_matrix(k, 3); !fault.empty())
    throw_bad_input(json, "intrinsics", fault, kBadFrame);
  set_intrinsics(frame, {k[0], k[4], k[2], k[5], 0, 0, json});
  const std::string number = frame.name.substr(frame.name.find('_') + 1);
  set_depth(frame, folder / ("depth_" + number + ".png"));
  frame.confidence = file_if_there(folder / ("conf_" + number + ".png"));
  return frame;
}

bool is_scanner_frame(const fs::path& file) { return file.filename().string().rfind("frame_", 0) == 0; }

}  // namespace

bool may_hold_polycam(const fs::path& folder) {
  const fs::path keyframes = folder / "keyframes";
  return fs::is_directory(keyframes / "cameras") || fs::is_directory(keyframes / "corrected_cameras");
}

bool may_hold_scanner_app(const fs::path& folder) {
  const std::vector<fs::path> files = list_files(folder, {".json"});
  return std::any_of(files.begin(), files.end(), [](const fs::path& file) {
    return is_scanner_frame(file) && read_file(file).find("\"cameraPoseARFrame\"") != std::string::npos;
  });
}

Capture read_polycam(const fs::path& folder, const CaptureOptions&) {
  Capture capture = arkit_capture(folder);
  capture.depth_files = "keyframes/depth/NAME.png";
  const fs::path keyframes = folder / "keyframes";
  const fs::path cameras = better_of(keyframes / "corrected_cameras", keyframes / "cameras", {".json"});
  const fs::path images = better_of(keyframes / "corrected_images", keyframes / "images", picture_extensions());
  if (cameras.filename() == "cameras")
    capture.notes.push_back(
        "there are no corrected cameras: these are as the telephone tracked them, a few pixels off");
  if (images.filename() == "images")
    capture.notes.push_back("there are no corrected photos: the lens's distortion stays in them");
  const std::vector<fs::path> photos = list_frame_photos(capture, images);
  note_poses_without_photo(capture, cameras, photos, ".json");
  for (const fs::path& image : photos) {
    const std::string name = image.stem().string();
    add_frame(capture, name, [&] { return polycam_frame(image, cameras / (name + ".json"), keyframes); });
  }
  return capture;
}

Capture read_scanner_app(const fs::path& folder, const CaptureOptions&) {
  Capture capture = arkit_capture(folder);
  capture.depth_files = "depth_NUMBER.png";
  for (const fs::path& image : list_frame_photos(capture, folder)) {  // most frames have a JSON and no photo
    if (!is_scanner_frame(image)) continue;
    add_frame(capture, image.stem().string(), [&] { return scanner_frame(image, folder); });
  }
  return capture;
}

}  // namespace aligngs
