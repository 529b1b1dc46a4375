// ScanNet's Python export (SensReader): color/N.jpg, depth/N.png (uint16 mm), pose/N.txt (4x4 camera-to-world, -inf
// where tracking was lost), intrinsic/{intrinsic,extrinsic}_{color,depth}.txt (4x4), *_vh_clean_2.ply beside or above.
// The benchmark's frames ("scannet_frames_25k") have intrinsics_{color,depth}.txt in the folder itself.
// Intrinsics count from the centre of the first pixel, so half a pixel is added.
// Extrinsics map each sensor's frame to a common one. In calibrated captures both are identities. Poses are taken as
// those of the colour camera, with a warning where its extrinsic is another matrix.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/frame_photos.h"
#include "scene/import/intrinsics.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

std::vector<double> read_matrix4(const fs::path& file) {
  std::vector<double> m = read_numbers(file);
  if (m.size() != 16)
    throw_bad_input(file, "matrix", "expected 4x4 numbers, found " + std::to_string(m.size()),
                    "export the scan again with SensReader");
  return m;
}

/// Empty where there is none.
fs::path intrinsics_file(const fs::path& folder, const std::string& sensor) {
  return first_existing({folder / "intrinsic" / ("intrinsic_" + sensor + ".txt"),
                         folder / ("intrinsics_" + sensor + ".txt"), folder / ("intrinsic_" + sensor + ".txt")});
}

/// A sensor's frame to the common one; the identity where there is no file.
Rigidd read_extrinsic(const fs::path& file) {
  return fs::exists(file) ? rigid_from_matrix(read_matrix4(file), file, "matrix") : Rigidd{};
}

bool is_identity(const Rigidd& motion) {
  constexpr double kRounding = 1e-4;  // of printed rotations, and metres
  double deviation = norm(motion.translation);
  for (int i = 0; i < 9; ++i)
    deviation = std::max(deviation, std::fabs(motion.rotation.m[i] - (i % 4 == 0 ? 1.0 : 0.0)));
  return deviation < kRounding;
}

/// Depth camera to colour camera. Error{kBadInput} for a distance that no device has, as of other units than metres.
Rigidd depth_to_color(const Rigidd& color, const Rigidd& depth, const fs::path& file) {
  constexpr double kFarthest = 1;  // metres; sensors of one device are some centimetres apart
  const Rigidd motion = color.inverse() * depth;
  const double distance = norm(motion.translation);
  if (distance > kFarthest)
    throw_bad_input(file, "matrix",
                    fmt::format("by the extrinsics, depth and colour camera are {:.4g} m apart", distance),
                    "write the translations of both extrinsics in metres");
  return motion;
}

fs::path find_mesh(const fs::path& folder) {
  for (const fs::path& file : list_files(folder, {".ply"})) {
    const std::string name = file.filename().string();
    if (name.size() > 15 && name.find("_vh_clean_2.ply") != std::string::npos) return file;
  }
  return first_existing({folder / "gt_mesh.ply", folder / "mesh.ply"});
}

}  // namespace

Capture read_scannet(const fs::path& folder, const CaptureOptions&) {
  constexpr double kHalfPixel = 0.5;  // integer-centre convention of the files to the corner convention used here
  Capture capture;
  capture.folder = folder;
  capture.metric = true;
  capture.up = Vec3d{0, 0, 1};
  capture.up_measured = true;
  capture.up_source = "ScanNet's convention (+z)";
  const fs::path intrinsic = folder / "intrinsic";
  const fs::path color_file = intrinsics_file(folder, "color"), depth_file = intrinsics_file(folder, "depth");
  if (color_file.empty())
    throw_bad_input(folder, "intrinsic/intrinsic_color.txt", "the intrinsics of the colour camera are missing",
                    "export the scan again with SensReader's --export_intrinsics");
  Intrinsics color = read_intrinsics(color_file);
  color.cx += kHalfPixel;
  color.cy += kHalfPixel;
  const std::vector<fs::path> photos = list_frame_photos(capture, folder / "color");
  note_poses_without_photo(capture, folder / "pose", photos);
  const fs::path depths = folder_called(folder, "depth");
  capture.depth_files = depths.filename().string() + "/NUMBER.png";
  for (const fs::path& image : photos) {
    const std::string name = image.stem().string();
    add_frame(capture, name, [&] {
      CapturedFrame frame;
      frame.name = name;
      frame.image = image;
      const fs::path pose = numbers_file(folder / "pose" / name);
      if (!fs::exists(pose)) throw_bad_input(pose, "", "it has no pose", "add the pose or remove the image");
      const std::vector<double> m = read_matrix4(pose);
      if (!all_finite(m.data(), 16))
        throw_bad_input(pose, "matrix", "lost tracking (pose is not finite)", "leave this frame out");
      frame.world_to_camera = rigid_from_matrix(m, pose, "matrix").inverse();
      set_depth(frame, depths / (name + ".png"));
      set_intrinsics(frame, color);
      return frame;
    });
  }
  const fs::path depth_extrinsic = intrinsic / "extrinsic_depth.txt";
  const Rigidd color_to_common = read_extrinsic(intrinsic / "extrinsic_color.txt");
  if (!is_identity(color_to_common)) {
    capture.notes.push_back(
        "intrinsic/extrinsic_color.txt is not the identity: poses are taken as those of the colour camera. The poses "
        "of an uncalibrated capture may be those of the common frame: multiply each by this matrix first (pose * "
        "extrinsic_color)");
  }
  if (!depth_file.empty()) {
    const Intrinsics d = read_intrinsics(depth_file);
    DepthCamera camera{d.fx, d.fy, d.cx + kHalfPixel, d.cy + kHalfPixel, {}, depth_file};
    camera.to_color = depth_to_color(color_to_common, read_extrinsic(depth_extrinsic), depth_extrinsic);
    capture.depth_camera = camera;
  }
  capture.mesh = find_mesh(folder);
  return capture;
}

}  // namespace aligngs
