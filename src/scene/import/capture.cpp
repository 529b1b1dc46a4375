#include "scene/import/capture.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/intrinsics.h"
#include "scene/import/unknown_layout.h"
#include "scene/lens_model.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

bool holds(const fs::path& folder, std::initializer_list<const char*> names) {
  return std::all_of(names.begin(), names.end(), [&](const char* name) { return fs::exists(folder / name); });
}

bool is_rgbd(const fs::path& folder) { return holds(folder, {"poses", "intrinsics.txt"}); }
bool is_scannet(const fs::path& folder) { return holds(folder, {"color", "pose"}); }
bool is_neural_rgbd(const fs::path& folder) {
  return holds(folder, {"focal.txt", "poses.txt"}) || holds(folder, {"focal.txt", "trainval_poses.txt"});
}
bool is_replica(const fs::path& folder) { return holds(folder, {"traj.txt", "results"}); }
bool is_tum(const fs::path& folder) { return holds(folder, {"groundtruth.txt", "rgb.txt"}); }

bool holds_poses(const fs::path& sequence) {
  const std::vector<fs::path> files = list_files(sequence, {".txt"});
  return std::any_of(files.begin(), files.end(), [](const fs::path& file) {
    return file.filename().string().find(".pose.txt") != std::string::npos;
  });
}

/// Frames of one sequence, or sequences; seq-01/seq-01/ is one that was unpacked into a folder of its name.
bool is_seven_scenes(const fs::path& folder) {
  if (holds_poses(folder)) return true;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path name = entry->path().filename();
    if (name.string().rfind("seq-", 0) != 0) continue;
    if (holds_poses(entry->path()) || holds_poses(entry->path() / name)) return true;
  }
  return false;
}

/// The row of a name, or of the first layout that is recognised.
const CaptureLayout& layout_of(const fs::path& folder, const std::string& name) {
  if (name == "auto") {
    if (const CaptureLayout* layout = recognise_layout(folder)) return *layout;
    refuse_layout(folder);
  }
  for (const CaptureLayout& layout : capture_layouts()) {
    if (name != layout.name) continue;
    if (layout.found(folder)) return layout;
    throw_bad_input(folder, "--layout " + name, std::string("this has not the files of ") + layout.title,
                    std::string("give the folder that holds ") + layout.files + ", or leave --layout out");
  }
  throw_usage("there is no layout \"" + name + "\"", "known: " + known_layouts());
}

/// The intrinsics of a depth sensor have to be those of its maps.
void require_depth_camera(const DepthCamera& camera, const ImageF& depth) {
  lens_of(pinhole_camera(camera.fx, camera.fy, camera.cx, camera.cy, depth.width, depth.height), camera.file);
  if (const std::string problem = misfit_of_intrinsics(camera.cx, camera.cy, depth.width, depth.height);
      !problem.empty())
    throw_bad_input(camera.file, "matrix", problem, "give the intrinsics of the depth sensor");
}

/// Moves depth from its own camera to the colour camera: each sample goes to the nearest pixel of a map. The map has
/// the depth image's width and the colour image's aspect. The nearer sample wins.
ImageF register_to_color(const ImageF& depth, const DepthCamera& from, const ColmapCamera& color) {
  const Camera camera = lens_of(color, "camera").pinhole();
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(depth.width) * camera.height / camera.width)));
  const Camera at_depth = camera.resized(depth.width, height);
  const double fx = at_depth.fx, fy = at_depth.fy, cx = at_depth.cx, cy = at_depth.cy;
  ImageF out(depth.width, height, 1, 0.f);
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const double z = depth.at(x, y);
      if (!(z > 0)) continue;
      const Vec3d p = from.to_color * Vec3d{(x + 0.5 - from.cx) / from.fx * z, (y + 0.5 - from.cy) / from.fy * z, z};
      if (!(p.z > 0)) continue;
      const double u = fx * p.x / p.z + cx, v = fy * p.y / p.z + cy;
      if (!(u >= 0 && v >= 0 && u < out.width && v < out.height)) continue;
      float& target = out.at(static_cast<int>(u), static_cast<int>(v));
      if (target == 0 || p.z < target) target = static_cast<float>(p.z);
    }
  }
  return out;
}

}  // namespace

const std::vector<CaptureLayout>& capture_layouts() {
  static const std::vector<CaptureLayout> layouts = {
      {"rgbd", "RGB-D", "images/ depth/ poses/ intrinsics.txt", is_rgbd, read_rgbd_folder},
      {"scannet", "ScanNet", "color/ depth/ pose/ intrinsic/", is_scannet, read_scannet},
      {"nrgbd", "Neural RGB-D", "images/ poses.txt focal.txt", is_neural_rgbd, read_neural_rgbd},
      {"replica", "Replica", "results/ traj.txt", is_replica, read_replica},
      {"tum", "TUM RGB-D", "rgb.txt groundtruth.txt", is_tum, read_tum},
      {"polycam", "Polycam", "keyframes/", may_hold_polycam, read_polycam},
      {"nerfstudio", "nerfstudio", "transforms.json or transforms_train.json", may_hold_transforms, read_transforms},
      {"7scenes", "7-Scenes", "frame-*.pose.txt or seq-*/", is_seven_scenes, read_seven_scenes},
      {"3dscanner", "3D Scanner App", "frame_*.json", may_hold_scanner_app, read_scanner_app},
      {"colmap", "COLMAP", "sparse/", may_hold_colmap_model, read_colmap_capture}};
  return layouts;
}

const CaptureLayout* recognise_layout(const fs::path& folder) {
  for (const CaptureLayout& layout : capture_layouts()) {
    if (layout.found(folder)) return &layout;
  }
  return nullptr;
}

const CaptureLayout* recognise_posed_capture(const fs::path& folder) {
  const CaptureLayout* layout = recognise_layout(folder);
  const bool read_elsewhere =
      layout && (layout->found == may_hold_transforms || layout->found == may_hold_colmap_model);
  return read_elsewhere ? nullptr : layout;
}

void refuse_posed_capture(const fs::path& folder, const std::string& remedy) {
  const CaptureLayout* layout = recognise_posed_capture(folder);
  if (!layout) return;
  throw_bad_input(folder, "", std::string("this is a capture (") + layout->title + "), which has cameras of its own",
                  remedy);
}

std::string known_layouts() {
  std::string known;
  for (const CaptureLayout& layout : capture_layouts()) {
    known += std::string(known.empty() ? "" : ", ") + layout.title + " (" + layout.files + ")";
  }
  return known;
}

Capture read_capture(const fs::path& folder, const CaptureOptions& options) {
  require_capture_folder(folder);
  const CaptureLayout& layout = layout_of(folder, options.layout);
  Capture capture = layout.read(folder, options);
  capture.layout = layout.name;
  finish_capture(capture);
  return capture;
}

ImageF read_capture_depth(const Capture& capture, const CapturedFrame& frame) {
  if (frame.depth.empty()) return {};
  constexpr uint16_t kInvalid = 65535;
  if (read_image_info(frame.depth).bit_depth < 16)
    throw_bad_input(frame.depth, "", kDepthOfEightBits, "save depth as 16-bit PNG");
  const Image<uint16_t> raw = read_gray_png(frame.depth);
  const double unit = capture.depth_unit * frame.depth_scale;
  ImageF depth(raw.width, raw.height, 1, 0.f);
  for (size_t i = 0; i < raw.data.size(); ++i) {
    if (raw.data[i] != 0 && raw.data[i] != kInvalid) depth.data[i] = static_cast<float>(raw.data[i] * unit);
  }
  if (!frame.confidence.empty()) {
    const Image<uint16_t> confidence = read_gray_png(frame.confidence);
    if (confidence.width != depth.width || confidence.height != depth.height) {
      throw_bad_input(frame.confidence, "size", "the confidence has another size than its depth",
                      "export the capture again, or remove the file");
    }
    const bool any =
        std::any_of(confidence.data.begin(), confidence.data.end(), [](uint16_t value) { return value != 0; });
    if (!any)
      throw_bad_input(frame.confidence, "values", "no pixel has a confidence above 0, so its depth counts as none",
                      "remove this file to use all depth, or leave the frame out");
    for (size_t i = 0; i < depth.data.size(); ++i) {
      if (confidence.data[i] == 0) depth.data[i] = 0;
    }
  }
  if (!capture.depth_camera) return depth;
  require_depth_camera(*capture.depth_camera, depth);
  return register_to_color(depth, *capture.depth_camera, frame.camera);
}

}  // namespace aligngs
