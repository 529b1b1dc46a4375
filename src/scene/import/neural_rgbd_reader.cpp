// Neural RGB-D: images/imgN.png, depth/ or depth_filtered/ depthN.png (uint16 mm), focal.txt (one number), poses.txt and
// trainval_poses.txt (4N x 4 camera-to-world, OpenGL axes; a matrix whose first line holds "nan" is invalid), gt_mesh.ply.
// The principal point is not stored; it is the image centre.
#include <string>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture.h"
#include "scene/import/capture_text.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

std::string digits_of(const std::string& name) {
  std::string digits;
  for (const char c : name) {
    if (c >= '0' && c <= '9') digits += c;
  }
  return digits;
}

}  // namespace

Capture read_neural_rgbd(const fs::path& folder, const CaptureOptions& options) {
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kNeuralRgbd);
  capture.folder = folder;
  capture.metric = true;
  const fs::path focal_file = folder / "focal.txt";
  const std::vector<double> focal = read_numbers(focal_file);
  if (focal.size() != 1 || !(focal[0] > 0)) throw_bad_input(focal_file, "focal", "expected one positive number", "the focal length in pixels");

  const fs::path pose_file = folder / (options.neural_rgbd_trajectory ? "trainval_poses.txt" : "poses.txt");
  const std::vector<double> poses = read_numbers(pose_file);
  const std::vector<fs::path> images = list_files(folder / "images", {".png", ".jpg"});
  if (poses.size() != 16 * images.size()) {
    throw_bad_input(pose_file, "matrices", "there are " + std::to_string(images.size()) + " images but " + std::to_string(poses.size() / 16) + " poses",
                    "poses.txt needs four lines of four numbers per image");
  }
  const fs::path depth_folder = first_existing({folder / "depth", folder / "depth_filtered", folder / "depth_with_noise"});
  for (size_t i = 0; i < images.size(); ++i) {
    CapturedFrame frame;
    frame.name = images[i].stem().string();
    frame.image = images[i];
    if (!depth_folder.empty()) {
      const fs::path depth = depth_folder / ("depth" + digits_of(frame.name) + ".png");
      if (fs::exists(depth)) frame.depth = depth;
    }
    const double* m = &poses[16 * i];
    if (!all_finite(m, 16)) {
      capture.skipped.push_back(frame.name + ": pose is nan");
      continue;
    }
    frame.world_to_camera = opencv_world_to_camera_from_opengl(rigid_from_matrix(m, pose_file, "matrix " + std::to_string(i)));
    const ImageInfo info = read_image_info(frame.image);
    frame.camera = pinhole_camera(focal[0], focal[0], info.width / 2.0, info.height / 2.0, info.width, info.height);
    capture.frames.push_back(std::move(frame));
  }
  capture.mesh = options.neural_rgbd_trajectory ? fs::path() : first_existing({folder / "gt_mesh.ply", folder / "gt_mesh_culled.ply"});
  return capture;
}

}  // namespace aligngs
