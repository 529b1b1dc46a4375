// A plain RGB-D folder with registered depth:
//   images/NAME.jpg|png   depth/NAME.png (uint16 mm)   poses/NAME.txt (4x4 camera-to-world, OpenCV axes)
//   intrinsics.txt (3x3)  train.txt, test.txt (frame names; optional)   reference_mesh.ply (optional)
// Photos may lie in subfolders: images/left/NAME.jpg has depth/left/NAME.png and poses/left/NAME.txt.
// The 7-Scenes form is read as well: [seq-*/]frame-NNNNNN.{color.png|jpg,depth.png,pose.txt}.
#include <algorithm>
#include <set>

#include "core/error.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/frame_photos.h"
#include "scene/import/intrinsics.h"
#include "scene/import/unknown_layout.h"
#include "scene/photo_lookup.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> read_names(const fs::path& file) {
  return fs::exists(file) ? read_name_list(file) : std::vector<std::string>{};
}

/// A frame with its pose and intrinsics. Error{kBadInput} when it cannot be used.
CapturedFrame posed_frame(const std::string& name, const fs::path& image, const fs::path& depth,
                          const fs::path& pose_file, const Intrinsics& k) {
  CapturedFrame frame;
  frame.name = as_utf8(name);
  frame.image = image;
  if (!fs::exists(pose_file)) throw_bad_input(pose_file, "", "it has no pose", "add the pose or remove the image");
  const std::vector<double> m = read_numbers(pose_file);
  if (m.size() != 16 && m.size() != 12)
    throw_bad_input(pose_file, "matrix", "expected 4x4 numbers", "one camera-to-world matrix per file");
  if (!all_finite(m.data(), m.size()))
    throw_bad_input(pose_file, "matrix", "lost tracking (pose is not finite)", "leave this frame out");
  frame.world_to_camera = rigid_from_scaled_matrix(m, pose_file, "matrix", frame.depth_scale).inverse();
  set_depth(frame, depth);
  if (k.width > 0)
    set_camera(frame, pinhole_camera(k.fx, k.fy, k.cx, k.cy, k.width, k.height), k.file);
  else
    set_intrinsics(frame, k);
  return frame;
}

/// The folders that hold the frames of 7-Scenes. An archive that was unpacked into a folder of its name has them in
/// seq-01/seq-01/.
std::vector<fs::path> sequences_of(Capture& capture, const fs::path& folder) {
  std::vector<fs::path> sequences;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& place = entry.path();
    if (place.filename().string().rfind("seq", 0) != 0) continue;
    const fs::path inner = place / place.filename();
    if (entry.is_directory()) sequences.push_back(fs::is_directory(inner) ? inner : place);
    const bool packed = is_archive(place) && !fs::exists(folder / place.stem());
    if (packed)
      capture.notes.push_back(as_utf8(place.filename().string()) + " is not unpacked: its frames are not used");
  }
  std::sort(sequences.begin(), sequences.end());
  if (sequences.empty()) sequences.push_back(folder);
  return sequences;
}

void note_frames_without_photo(Capture& capture, const fs::path& sequence, const std::string& prefix,
                               const std::vector<fs::path>& photos) {
  std::set<std::string> names;
  for (const fs::path& photo : photos) {
    const std::string name = photo.filename().string();
    names.insert(name.substr(0, name.find(".color.")));
  }
  for (const fs::path& pose : list_files(sequence, {".txt"})) {
    const std::string name = pose.filename().string();
    const size_t end = name.find(".pose.");
    if (end != std::string::npos && !names.count(name.substr(0, end)))
      capture.left_out.push_back(
          {as_utf8(prefix + name.substr(0, end)), PhotoLookup::kMissing, "add the photo or remove its pose"});
  }
}

}  // namespace

Capture read_rgbd_folder(const fs::path& folder, const CaptureOptions&) {
  Capture capture;
  capture.folder = folder;
  capture.metric = true;
  const Intrinsics k = read_intrinsics(folder / "intrinsics.txt");
  const std::vector<FileBelow> photos = list_photos_below(capture, folder / "images");
  note_poses_without_photo(capture, folder / "poses", photos);
  const fs::path depths = folder_called(folder, "depth");
  capture.depth_files = depths.filename().string() + "/NAME.png";
  for (const FileBelow& photo : photos) {
    add_frame(capture, photo.name, [&] {
      return posed_frame(photo.name, photo.file, depths / (photo.name + ".png"),
                         numbers_file(folder / "poses" / photo.name), k);
    });
  }
  capture.train = read_names(folder / "train.txt");
  capture.test = read_names(folder / "test.txt");
  capture.mesh = first_existing({folder / "reference_mesh.ply", folder / "mesh.ply"});
  return capture;
}

Capture read_seven_scenes(const fs::path& folder, const CaptureOptions& options) {
  Capture capture;
  capture.folder = folder;
  capture.metric = true;
  if (options.intrinsics.empty() && !options.assume_registered) {
    throw_bad_input(folder, "intrinsics",
                    "7-Scenes colour is not registered to depth (10 to 45 px) and its shipped intrinsics are those of "
                    "the depth camera",
                    "give --intrinsics FILE (3x3, of the colour camera) or --assume-registered");
  }
  const Intrinsics k =
      options.intrinsics.empty() ? Intrinsics{585, 585, 320, 240, 640, 480} : read_intrinsics(options.intrinsics);
  const std::vector<fs::path> sequences = sequences_of(capture, folder);
  if (options.assume_registered) capture.depth_files = "frame-NUMBER.depth.png";
  for (const fs::path& sequence : sequences) {
    const std::string prefix = sequences.size() > 1 ? sequence.filename().string() + "_" : "";
    const std::vector<fs::path> photos = list_frame_photos(capture, sequence, {".png", ".jpg"});
    note_frames_without_photo(capture, sequence, prefix, photos);
    for (const fs::path& image : photos) {
      const std::string file = image.filename().string();
      const size_t cut = file.find(".color.");
      if (cut == std::string::npos) continue;
      const std::string stem = file.substr(0, cut);
      const fs::path depth = options.assume_registered ? sequence / (stem + ".depth.png") : fs::path();
      add_frame(capture, prefix + stem,
                [&] { return posed_frame(prefix + stem, image, depth, sequence / (stem + ".pose.txt"), k); });
    }
  }
  if (!options.assume_registered)
    capture.notes.push_back("depth is not registered to colour and not used (--assume-registered uses it as it is)");
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
