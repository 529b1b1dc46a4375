// Replica as rendered for NICE-SLAM: [ROOM/]results/frameNNNNNN.jpg and depthNNNNNN.png (1/6553.5 m), [ROOM/]traj.txt
// (16 numbers per line, camera-to-world, OpenCV axes), ROOM_mesh.ply or mesh.ply; 1200x680, f = 600, centre (599.5, 339.5)
// counted from the centre of the first pixel.
#include "core/error.h"
#include "io/image_file.h"
#include "scene/import/capture.h"
#include "scene/import/capture_text.h"

namespace aligngs {

namespace fs = std::filesystem;

Capture read_replica(const fs::path& folder) {
  constexpr double kDepthUnit = 1.0 / 6553.5;  // metres per stored value
  constexpr double kFocal = 600;               // pixels at 1200 x 680
  constexpr int kWidth = 1200;
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kReplica);
  capture.folder = folder;
  capture.metric = true;
  capture.depth_unit = kDepthUnit;
  const fs::path trajectory = folder / "traj.txt";
  const std::vector<double> poses = read_numbers(trajectory);
  std::vector<fs::path> images;
  for (const fs::path& file : list_files(folder / "results", {".jpg", ".png"})) {
    if (file.filename().string().rfind("frame", 0) == 0) images.push_back(file);
  }
  if (poses.size() != 16 * images.size()) {
    throw_bad_input(trajectory, "lines", "there are " + std::to_string(images.size()) + " frames but " + std::to_string(poses.size() / 16) + " poses",
                    "traj.txt needs 16 numbers per frame");
  }
  for (size_t i = 0; i < images.size(); ++i) {
    CapturedFrame frame;
    frame.name = images[i].stem().string();
    frame.image = images[i];
    const fs::path depth = folder / "results" / ("depth" + frame.name.substr(5) + ".png");
    if (fs::exists(depth)) frame.depth = depth;
    if (!all_finite(&poses[16 * i], 16)) {
      capture.skipped.push_back(frame.name + ": pose is not finite");
      continue;
    }
    frame.world_to_camera = rigid_from_matrix(&poses[16 * i], trajectory, "line " + std::to_string(i + 1)).inverse();
    const ImageInfo info = read_image_info(frame.image);
    const double scale = static_cast<double>(info.width) / kWidth;
    frame.camera = pinhole_camera(kFocal * scale, kFocal * scale, info.width / 2.0, info.height / 2.0, info.width, info.height);
    capture.frames.push_back(std::move(frame));
  }
  capture.mesh = first_existing({folder / "mesh.ply", folder.parent_path() / (folder.filename().string() + "_mesh.ply")});
  return capture;
}

}  // namespace aligngs
