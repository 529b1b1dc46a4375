// A plain RGB-D folder with registered depth:
//   images/NAME.jpg|png   depth/NAME.png (uint16 mm)   poses/NAME.txt (4x4 camera-to-world, OpenCV axes)
//   intrinsics.txt (3x3)  train.txt, test.txt (frame names; optional)   reference_mesh.ply (optional)
// and the 7-Scenes form: [seq-*/]frame-NNNNNN.{color.png|jpg,depth.png,pose.txt}.
#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "scene/import/capture.h"
#include "scene/import/capture_text.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct Intrinsics {
  double fx, fy, cx, cy;
};

Intrinsics read_intrinsics(const fs::path& file) {
  const std::vector<double> k = read_numbers(file);
  if (k.size() != 9 && k.size() != 16) {
    throw_bad_input(file, "matrix", "expected a 3x3 or 4x4 matrix, found " + std::to_string(k.size()) + " numbers", "write fx 0 cx / 0 fy cy / 0 0 1");
  }
  const size_t row = k.size() == 9 ? 3 : 4;
  const Intrinsics r{k[0], k[row + 1], k[2], k[row + 2]};
  if (!(r.fx > 0) || !(r.fy > 0)) throw_bad_input(file, "fx, fy", "focal lengths must be positive", "check the order of the matrix");
  return r;
}

std::vector<std::string> read_names(const fs::path& file) {
  std::vector<std::string> names;
  if (!fs::exists(file)) return names;
  std::istringstream lines(read_file(file));
  for (std::string word; lines >> word;) names.push_back(word);
  return names;
}

/// Adds a frame, or a line to `skipped` when its pose is not finite.
void add_frame(Capture& capture, CapturedFrame frame, const fs::path& pose_file, const Intrinsics& k) {
  const std::vector<double> m = read_numbers(pose_file);
  if (m.size() != 16 && m.size() != 12) throw_bad_input(pose_file, "matrix", "expected 4x4 numbers", "one camera-to-world matrix per file");
  if (!all_finite(m.data(), m.size())) {
    capture.skipped.push_back(frame.name + ": lost tracking (pose is not finite)");
    return;
  }
  frame.world_to_camera = rigid_from_matrix(m.data(), pose_file, "matrix").inverse();
  const ImageInfo info = read_image_info(frame.image);
  frame.camera = pinhole_camera(k.fx, k.fy, k.cx, k.cy, info.width, info.height);
  capture.frames.push_back(std::move(frame));
}

}  // namespace

Capture read_rgbd_folder(const fs::path& folder) {
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kRgbd);
  capture.folder = folder;
  capture.metric = true;
  const Intrinsics k = read_intrinsics(folder / "intrinsics.txt");
  for (const fs::path& image : list_files(folder / "images", {".jpg", ".jpeg", ".png"})) {
    CapturedFrame frame;
    frame.name = image.stem().string();
    frame.image = image;
    const fs::path depth = folder / "depth" / (frame.name + ".png");
    if (fs::exists(depth)) frame.depth = depth;
    const fs::path pose = folder / "poses" / (frame.name + ".txt");
    if (!fs::exists(pose)) throw_bad_input(pose, "", "the image " + image.filename().string() + " has no pose", "add the pose or remove the image");
    add_frame(capture, std::move(frame), pose, k);
  }
  capture.train = read_names(folder / "train.txt");
  capture.test = read_names(folder / "test.txt");
  capture.mesh = first_existing({folder / "reference_mesh.ply", folder / "mesh.ply"});
  return capture;
}

Capture read_seven_scenes(const fs::path& folder, const CaptureOptions& options) {
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kSevenScenes);
  capture.folder = folder;
  capture.metric = true;
  if (options.intrinsics.empty() && !options.assume_registered) {
    throw_bad_input(folder, "intrinsics",
                    "7-Scenes colour is not registered to depth (10 to 45 px) and its shipped intrinsics are those of the depth camera",
                    "give --intrinsics FILE (3x3, of the colour camera) or --assume-registered");
  }
  const Intrinsics k = options.intrinsics.empty() ? Intrinsics{585, 585, 320, 240} : read_intrinsics(options.intrinsics);
  std::vector<fs::path> sequences;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && entry.path().filename().string().rfind("seq", 0) == 0) sequences.push_back(entry.path());
  }
  std::sort(sequences.begin(), sequences.end());
  if (sequences.empty()) sequences.push_back(folder);
  for (const fs::path& sequence : sequences) {
    const std::string prefix = sequences.size() > 1 ? sequence.filename().string() + "_" : "";
    for (const fs::path& image : list_files(sequence, {".png", ".jpg"})) {
      const std::string file = image.filename().string();
      const size_t cut = file.find(".color.");
      if (cut == std::string::npos) continue;
      CapturedFrame frame;
      frame.name = prefix + file.substr(0, cut);
      frame.image = image;
      const fs::path depth = sequence / (file.substr(0, cut) + ".depth.png");
      if (options.assume_registered && fs::exists(depth)) frame.depth = depth;
      add_frame(capture, std::move(frame), sequence / (file.substr(0, cut) + ".pose.txt"), k);
    }
  }
  if (!options.assume_registered) capture.skipped.push_back("depth: not registered to colour, left out (--assume-registered uses it as it is)");
  return capture;
}

ColmapCamera pinhole_camera(double fx, double fy, double cx, double cy, int width, int height) {
  ColmapCamera camera;
  camera.id = 1;
  camera.model = "PINHOLE";
  camera.width = static_cast<uint64_t>(width);
  camera.height = static_cast<uint64_t>(height);
  camera.params = {fx, fy, cx, cy};
  return camera;
}

}  // namespace aligngs
