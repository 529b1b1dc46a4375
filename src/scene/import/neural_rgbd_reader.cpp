// Neural RGB-D: images/imgN.png, depth/ or depth_filtered/ depthN.png (uint16 mm), focal.txt (one number), poses.txt
// and trainval_poses.txt, gt_mesh.ply. Poses are 4N x 4 camera-to-world, OpenGL axes; a matrix whose first line holds
// "nan" is invalid. The principal point is not stored; it is the image centre.
#include <span>
#include <string>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/frame_photos.h"

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
  capture.folder = folder;
  capture.metric = true;
  const fs::path focal_file = folder / "focal.txt";
  const std::vector<double> focal = read_numbers(focal_file);
  if (focal.size() != 1 || !(focal[0] > 0))
    throw_bad_input(focal_file, "focal", "expected one positive number", "the focal length in pixels");

  const fs::path pose_file = folder / (options.neural_rgbd_trajectory ? "trainval_poses.txt" : "poses.txt");
  const std::vector<double> poses = read_numbers(pose_file);
  if (poses.size() % 16 != 0)
    throw_bad_input(pose_file, "matrices", "the number of values is no multiple of 16",
                    "poses.txt needs four lines of four numbers per image");
  const std::vector<fs::path> images = list_frame_photos(capture, folder / "images", {".png", ".jpg"});
  const std::vector<int> pose_of = poses_of_numbered(capture, images, poses.size() / 16, pose_file);
  const fs::path depth_folder =
      first_existing({folder_called(folder, "depth"), folder / "depth_filtered", folder / "depth_with_noise"});
  capture.depth_files =
      (depth_folder.empty() ? std::string("depth") : depth_folder.filename().string()) + "/depthNUMBER.png";
  for (size_t i = 0; i < images.size(); ++i) {
    const std::string name = images[i].stem().string();
    add_frame(capture, name, [&] {
      CapturedFrame frame;
      frame.name = name;
      frame.image = images[i];
      if (pose_of[i] < 0) throw_bad_input(pose_file, "", "it has no pose", "add the pose or remove the image");
      const std::string field = "matrix " + std::to_string(pose_of[i]);
      frame.world_to_camera = opencv_world_to_camera_from_opengl(
          rigid_from_matrix(std::span(poses).subspan(16 * size_t(pose_of[i]), 16), pose_file, field));
      if (!depth_folder.empty()) set_depth(frame, depth_folder / ("depth" + digits_of(name) + ".png"));
      const ImageInfo info = read_image_info(frame.image);
      set_intrinsics(frame, {focal[0], focal[0], info.stored_width / 2.0, info.stored_height / 2.0, 0, 0, focal_file});
      return frame;
    });
  }
  capture.mesh = options.neural_rgbd_trajectory
                     ? fs::path()
                     : first_existing({folder / "gt_mesh.ply", folder / "gt_mesh_culled.ply"});
  return capture;
}

}  // namespace aligngs
