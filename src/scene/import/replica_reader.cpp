// Replica as rendered for NICE-SLAM: [ROOM/]results/frameNNNNNN.jpg and depthNNNNNN.png (1/6553.5 m), [ROOM/]traj.txt
// (16 numbers per line, camera-to-world, OpenCV axes), ROOM_mesh.ply or mesh.ply. 1200x680, f = 600, centre (599.5,
// 339.5) counted from the centre of the first pixel. A cam_params.json beside or above replaces these.
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/foreign_content.h"
#include "io/image_file.h"
#include "io/image_limits.h"
#include "io/json_text.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/frame_photos.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct ReplicaCamera {
  fs::path file{};                                                       ///< that has it; empty: the published one
  double w = 1200, h = 680, fx = 600, fy = 600, cx = 599.5, cy = 339.5;  ///< pixels; from the centre of the first pixel
  double scale = 6553.5;                                                 ///< stored depth values per metre
};

ReplicaCamera read_camera(const fs::path& folder) {
  ReplicaCamera camera;
  const fs::path file = first_existing({folder / "cam_params.json", folder.parent_path() / "cam_params.json"});
  if (file.empty()) return camera;
  camera.file = file;
  const std::string content = read_file(file);
  const std::string_view text = text_of_file(content, file);
  const nlohmann::json document = parse_json(text);
  if (document.is_discarded()) {
    refuse_foreign_content(text, file);
    throw_bad_input(file, place_of_json_fault(text), "this is no valid JSON", "correct this place");
  }
  if (!document.is_object() || !document.contains("camera") || !document["camera"].is_object()) {
    throw_bad_input(file, "camera", "an object with w, h, fx, fy, cx, cy and scale expected",
                    "correct or remove the file");
  }
  const std::pair<const char*, double*> fields[] = {{"w", &camera.w},        {"h", &camera.h},   {"fx", &camera.fx},
                                                    {"fy", &camera.fy},      {"cx", &camera.cx}, {"cy", &camera.cy},
                                                    {"scale", &camera.scale}};
  for (const auto& [key, value] : fields) {
    const auto found = document["camera"].find(key);
    if (found == document["camera"].end()) continue;
    if (!found->is_number() || !(found->get<double>() > 0))
      throw_bad_input(file, key, "a positive number expected", "correct the value");
    *value = found->get<double>();
  }
  if (!(camera.w <= kMaxImageSide && camera.h <= kMaxImageSide))
    throw_bad_input(file, "w, h", "no size of a photo", "the size of the photos in pixels");
  return camera;
}

}  // namespace

Capture read_replica(const fs::path& folder, const CaptureOptions&) {
  constexpr double kHalfPixel = 0.5;  // integer-centre convention of the files to the corner convention used here
  const ReplicaCamera camera = read_camera(fs::absolute(folder / "").parent_path());
  Capture capture;
  capture.folder = folder;
  capture.metric = true;
  capture.depth_unit = 1 / camera.scale;
  capture.depth_files = "results/depthNUMBER.png";
  const fs::path trajectory = folder / "traj.txt";
  const std::vector<double> poses = read_numbers(trajectory);
  if (poses.size() % 16 != 0)
    throw_bad_input(trajectory, "lines", "the number of values is no multiple of 16",
                    "traj.txt needs 16 numbers per frame");
  std::vector<fs::path> images;
  for (const fs::path& file : list_frame_photos(capture, folder / "results", {".jpg", ".png"})) {
    if (file.filename().string().rfind("frame", 0) == 0) images.push_back(file);
  }
  if (images.empty())
    throw_bad_input(folder / "results", "photos", "there are no photos called frame*.jpg or frame*.png",
                    "name them as NICE-SLAM does: frame000000.jpg and depth000000.png");
  const std::vector<int> pose_of = poses_of_numbered(capture, images, poses.size() / 16, trajectory);
  ColmapCamera model = pinhole_camera(camera.fx, camera.fy, camera.cx + kHalfPixel, camera.cy + kHalfPixel,
                                      int(camera.w), int(camera.h));
  for (size_t i = 0; i < images.size(); ++i) {
    const std::string name = images[i].stem().string();
    add_frame(capture, name, [&] {
      CapturedFrame frame;
      frame.name = name;
      frame.image = images[i];
      if (pose_of[i] < 0) throw_bad_input(trajectory, "", "it has no pose", "add the pose or remove the image");
      frame.world_to_camera = rigid_from_matrix(std::span(poses).subspan(16 * size_t(pose_of[i]), 16), trajectory,
                                                "line " + std::to_string(pose_of[i] + 1))
                                  .inverse();
      set_depth(frame, folder / "results" / ("depth" + name.substr(5) + ".png"));
      set_camera(frame, model, camera.file);
      return frame;
    });
  }
  capture.mesh =
      first_existing({folder / "mesh.ply", folder.parent_path() / (folder.filename().string() + "_mesh.ply")});
  return capture;
}

}  // namespace aligngs
