// ScanNet's Python export (SensReader): color/N.jpg, depth/N.png (uint16 mm), pose/N.txt (4x4 camera-to-world, -inf where
// tracking was lost), intrinsic/{intrinsic,extrinsic}_{color,depth}.txt (4x4), *_vh_clean_2.ply beside or above.
// Intrinsics count from the centre of the first pixel, so half a pixel is added.
#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture.h"
#include "scene/import/capture_text.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

std::vector<double> read_matrix4(const fs::path& file) {
  std::vector<double> m = read_numbers(file);
  if (m.size() != 16) throw_bad_input(file, "matrix", "expected 4x4 numbers, found " + std::to_string(m.size()), "export the scan again with SensReader");
  return m;
}

fs::path find_mesh(const fs::path& folder) {
  for (const fs::path& file : list_files(folder, {".ply"})) {
    const std::string name = file.filename().string();
    if (name.size() > 15 && name.find("_vh_clean_2.ply") != std::string::npos) return file;
  }
  return first_existing({folder / "gt_mesh.ply", folder / "mesh.ply"});
}

}  // namespace

Capture read_scannet(const fs::path& folder) {
  constexpr double kHalfPixel = 0.5;  // integer-centre convention of the files to the corner convention used here
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kScanNet);
  capture.folder = folder;
  capture.metric = true;
  capture.up = Vec3d{0, 0, 1};
  const fs::path intrinsic = folder / "intrinsic";
  const std::vector<double> color = read_matrix4(intrinsic / "intrinsic_color.txt");
  for (const fs::path& image : list_files(folder / "color", {".jpg", ".jpeg", ".png"})) {
    CapturedFrame frame;
    frame.name = image.stem().string();
    frame.image = image;
    const fs::path depth = folder / "depth" / (frame.name + ".png");
    if (fs::exists(depth)) frame.depth = depth;
    const fs::path pose = folder / "pose" / (frame.name + ".txt");
    const std::vector<double> m = read_matrix4(pose);
    if (!all_finite(m.data(), 16)) {
      capture.skipped.push_back(frame.name + ": lost tracking (pose is not finite)");
      continue;
    }
    frame.world_to_camera = rigid_from_matrix(m.data(), pose, "matrix").inverse();
    const ImageInfo info = read_image_info(image);
    frame.camera = pinhole_camera(color[0], color[5], color[2] + kHalfPixel, color[6] + kHalfPixel, info.width, info.height);
    capture.frames.push_back(std::move(frame));
  }
  if (fs::exists(intrinsic / "intrinsic_depth.txt")) {
    const std::vector<double> d = read_matrix4(intrinsic / "intrinsic_depth.txt");
    DepthCamera camera{d[0], d[5], d[2] + kHalfPixel, d[6] + kHalfPixel, {}};
    const fs::path color_extrinsic = intrinsic / "extrinsic_color.txt", depth_extrinsic = intrinsic / "extrinsic_depth.txt";
    if (fs::exists(color_extrinsic) && fs::exists(depth_extrinsic)) {
      // Extrinsics map each sensor's frame to the common one.
      camera.to_color = rigid_from_matrix(read_matrix4(color_extrinsic).data(), color_extrinsic, "matrix").inverse() *
                        rigid_from_matrix(read_matrix4(depth_extrinsic).data(), depth_extrinsic, "matrix");
    }
    capture.depth_camera = camera;
  }
  capture.mesh = find_mesh(folder);
  return capture;
}

}  // namespace aligngs
