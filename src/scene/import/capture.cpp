#include "scene/import/capture.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/unknown_layout.h"
#include "scene/lens_model.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

bool has_seven_scenes_frames(const fs::path& folder) {
  for (const fs::path& file : list_files(folder, {".txt"})) {
    if (file.filename().string().find(".pose.txt") != std::string::npos) return true;
  }
  return false;
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

CaptureLayout recognise_layout(const fs::path& folder) {
  if (fs::exists(folder / "poses") && fs::exists(folder / "intrinsics.txt")) return CaptureLayout::kRgbd;
  if (fs::exists(folder / "color") && fs::exists(folder / "pose")) return CaptureLayout::kScanNet;
  if (fs::exists(folder / "focal.txt") &&
      (fs::exists(folder / "poses.txt") || fs::exists(folder / "trainval_poses.txt")))
    return CaptureLayout::kNeuralRgbd;
  if (fs::exists(folder / "traj.txt") && fs::exists(folder / "results")) return CaptureLayout::kReplica;
  if (fs::exists(folder / "groundtruth.txt") && fs::exists(folder / "rgb.txt")) return CaptureLayout::kTum;
  if (may_hold_polycam(folder)) return CaptureLayout::kPolycam;
  if (may_hold_transforms(folder)) return CaptureLayout::kTransforms;
  if (has_seven_scenes_frames(folder)) return CaptureLayout::kSevenScenes;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && entry.path().filename().string().rfind("seq-", 0) == 0)
      return CaptureLayout::kSevenScenes;
  }
  if (may_hold_scanner_app(folder)) return CaptureLayout::kScannerApp;
  return may_hold_colmap_model(folder) ? CaptureLayout::kColmap : CaptureLayout::kAuto;
}

std::string layout_name(CaptureLayout layout) {
  switch (layout) {
    case CaptureLayout::kAuto:
      return "auto";
    case CaptureLayout::kRgbd:
      return "rgbd";
    case CaptureLayout::kSevenScenes:
      return "7scenes";
    case CaptureLayout::kTum:
      return "tum";
    case CaptureLayout::kScanNet:
      return "scannet";
    case CaptureLayout::kNeuralRgbd:
      return "nrgbd";
    case CaptureLayout::kReplica:
      return "replica";
    case CaptureLayout::kTransforms:
      return "nerfstudio";
    case CaptureLayout::kPolycam:
      return "polycam";
    case CaptureLayout::kScannerApp:
      return "3dscanner";
    case CaptureLayout::kColmap:
      return "colmap";
  }
  return "unknown";
}

Capture read_capture(const fs::path& folder, const CaptureOptions& options) {
  require_capture_folder(folder);
  const CaptureLayout layout = options.layout == CaptureLayout::kAuto ? recognise_layout(folder) : options.layout;
  Capture capture;
  switch (layout) {
    case CaptureLayout::kRgbd:
      capture = read_rgbd_folder(folder);
      break;
    case CaptureLayout::kSevenScenes:
      capture = read_seven_scenes(folder, options);
      break;
    case CaptureLayout::kTum:
      capture = read_tum(folder, options);
      break;
    case CaptureLayout::kScanNet:
      capture = read_scannet(folder);
      break;
    case CaptureLayout::kNeuralRgbd:
      capture = read_neural_rgbd(folder, options);
      break;
    case CaptureLayout::kReplica:
      capture = read_replica(folder);
      break;
    case CaptureLayout::kTransforms:
      capture = read_transforms(folder);
      break;
    case CaptureLayout::kPolycam:
      capture = read_polycam(folder);
      break;
    case CaptureLayout::kScannerApp:
      capture = read_scanner_app(folder);
      break;
    case CaptureLayout::kColmap:
      capture = read_colmap_capture(folder);
      break;
    case CaptureLayout::kAuto:
      refuse_layout(folder);
  }
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
    for (size_t i = 0; i < depth.data.size(); ++i) {
      if (confidence.data[i] == 0) depth.data[i] = 0;
    }
  }
  return capture.depth_camera ? register_to_color(depth, *capture.depth_camera, frame.camera) : depth;
}

}  // namespace aligngs
