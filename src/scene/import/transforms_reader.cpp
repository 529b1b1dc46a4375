// nerfstudio / Blender transforms.json: OpenGL camera-to-world per frame, fl_x fl_y cx cy w h (or camera_angle_x), OPENCV
// distortion k1 k2 p1 p2 (k3 k4 refused), per-frame overrides, depth_file_path (uint16 mm), ply_file_path,
// train_filenames / val_filenames / test_filenames.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "scene/import/capture.h"
#include "scene/import/capture_text.h"
#include "scene/mesh_ply.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

struct Reader {
  fs::path file;
  Json document;

  double number(const Json& frame, const char* key, double fallback) const {
    for (const Json* source : {&frame, &document}) {
      const auto found = source->find(key);
      if (found == source->end()) continue;
      if (!found->is_number() || !std::isfinite(found->get<double>())) throw_bad_input(file, key, "expected a finite number", "correct the value");
      return found->get<double>();
    }
    return fallback;
  }

  ColmapCamera camera(const Json& frame, const ImageInfo& info) const {
    const double w = number(frame, "w", info.width), h = number(frame, "h", info.height);
    double fx = number(frame, "fl_x", 0);
    if (!(fx > 0)) {
      const double angle = number(frame, "camera_angle_x", 0);
      if (!(angle > 0)) throw_bad_input(file, "fl_x", "no focal length (fl_x or camera_angle_x)", "add fl_x in pixels");
      fx = 0.5 * w / std::tan(0.5 * angle);
    }
    const double fy = number(frame, "fl_y", fx);
    if (number(frame, "k3", 0) != 0 || number(frame, "k4", 0) != 0) {
      throw_bad_input(file, "k3, k4", "fisheye or high-order distortion is not supported", "undistort the images first (nerfstudio, COLMAP)");
    }
    if (w != info.width || h != info.height) {
      throw_bad_input(file, "w, h", "the camera is " + std::to_string(int(w)) + "x" + std::to_string(int(h)) + " but its image is " +
                      std::to_string(info.width) + "x" + std::to_string(info.height), "use the images the file was made for");
    }
    ColmapCamera camera = pinhole_camera(fx, fy, number(frame, "cx", w / 2), number(frame, "cy", h / 2), info.width, info.height);
    const double k1 = number(frame, "k1", 0), k2 = number(frame, "k2", 0), p1 = number(frame, "p1", 0), p2 = number(frame, "p2", 0);
    if (k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0) {
      camera.model = "OPENCV";
      camera.params.insert(camera.params.end(), {k1, k2, p1, p2});
    }
    return camera;
  }
};

std::vector<std::string> stems(const Reader& reader, std::initializer_list<const char*> keys) {
  std::vector<std::string> names;
  for (const char* key : keys) {
    const auto found = reader.document.find(key);
    if (found == reader.document.end()) continue;
    if (!found->is_array()) throw_bad_input(reader.file, key, "expected a list of file names", "correct the value");
    for (const Json& name : *found) {
      if (name.is_string()) names.push_back(fs::path(name.get<std::string>()).stem().string());
    }
  }
  return names;
}

}  // namespace

Capture read_transforms(const fs::path& folder) {
  Reader reader{folder / "transforms.json", {}};
  reader.document = parse_json(read_file(reader.file));
  if (!reader.document.is_object() || !reader.document.contains("frames") || !reader.document["frames"].is_array()) {
    throw_bad_input(reader.file, "frames", "this is no transforms.json", "expected a JSON object with a list \"frames\"");
  }
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kTransforms);
  capture.folder = folder;
  size_t index = 0;
  for (const Json& item : reader.document["frames"]) {
    const std::string field = "frames[" + std::to_string(index++) + "]";
    if (!item.is_object() || !item.contains("file_path") || !item["file_path"].is_string() || !item.contains("transform_matrix")) {
      throw_bad_input(reader.file, field, "a frame needs file_path and transform_matrix", "correct the frame");
    }
    CapturedFrame frame;
    frame.image = folder / item["file_path"].get<std::string>();
    if (!fs::exists(frame.image) && frame.image.extension().empty()) frame.image += ".png";  // Blender leaves it out
    frame.name = frame.image.stem().string();
    if (item.contains("depth_file_path") && item["depth_file_path"].is_string()) frame.depth = folder / item["depth_file_path"].get<std::string>();
    std::vector<double> m;
    for (const Json& row : item["transform_matrix"]) {
      if (!row.is_array()) continue;
      for (const Json& v : row) m.push_back(v.is_number() ? v.get<double>() : NAN);
    }
    if (m.size() != 16 && m.size() != 12) throw_bad_input(reader.file, field + ".transform_matrix", "expected 4x4 numbers", "correct the matrix");
    if (!all_finite(m.data(), m.size())) {
      capture.skipped.push_back(frame.name + ": transform_matrix is not finite");
      continue;
    }
    frame.world_to_camera = opencv_world_to_camera_from_opengl(rigid_from_matrix(m.data(), reader.file, field));
    frame.camera = reader.camera(item, read_image_info(frame.image));
    capture.frames.push_back(std::move(frame));
  }
  capture.train = stems(reader, {"train_filenames"});
  capture.test = stems(reader, {"test_filenames", "val_filenames"});
  if (reader.document.contains("ply_file_path") && reader.document["ply_file_path"].is_string()) {
    capture.cloud = read_cloud_ply(folder / reader.document["ply_file_path"].get<std::string>());
  }
  return capture;
}

}  // namespace aligngs
