// TUM RGB-D: rgb.txt and depth.txt ("timestamp file" lines), groundtruth.txt ("timestamp tx ty tz qx qy qz qw",
// camera-to-world, OpenCV axes). Depth values are 1/5000 m. Times are matched within 0.02 s.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr double kAssociationSeconds = 0.02;  // the data set's own rule
constexpr double kDepthUnit = 1.0 / 5000;     // metres per stored value

struct Stamped {
  double time = 0;
  std::string rest;
};

std::vector<Stamped> read_stamped(const fs::path& file) {
  std::vector<Stamped> lines;
  std::istringstream text(std::string(text_of_file(read_file(file), file)));
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    Stamped entry;
    if (!(words >> entry.time))
      throw_bad_input(file, "line " + std::to_string(number), "expected a time stamp", "lines are \"time value...\"");
    std::getline(words >> std::ws, entry.rest);
    while (!entry.rest.empty() && std::isspace(static_cast<unsigned char>(entry.rest.back()))) entry.rest.pop_back();
    lines.push_back(entry);
  }
  return lines;
}

const Stamped* nearest(const std::vector<Stamped>& lines, double time) {
  const Stamped* best = nullptr;
  for (const Stamped& line : lines) {
    if (std::fabs(line.time - time) <= kAssociationSeconds &&
        (!best || std::fabs(line.time - time) < std::fabs(best->time - time)))
      best = &line;
  }
  return best;
}

}  // namespace

Capture read_tum(const fs::path& folder, const CaptureOptions& options) {
  if (options.intrinsics.empty()) {
    throw_bad_input(folder, "intrinsics", "TUM sequences do not carry their intrinsics",
                    "give --intrinsics FILE (3x3; freiburg1: 517.3 516.5 318.6 255.3)");
  }
  const std::vector<double> k = read_numbers(options.intrinsics);
  if (k.size() != 9 && k.size() != 16)
    throw_bad_input(options.intrinsics, "matrix", "expected a 3x3 or 4x4 matrix", "write fx 0 cx / 0 fy cy / 0 0 1");
  const size_t row = k.size() == 9 ? 3 : 4;
  Capture capture;
  capture.folder = folder;
  capture.metric = true;
  capture.depth_unit = kDepthUnit;
  const fs::path truth = folder / "groundtruth.txt";
  const std::vector<Stamped> colors = read_stamped(folder / "rgb.txt"), poses = read_stamped(truth);
  const std::vector<Stamped> depths =
      fs::exists(folder / "depth.txt") ? read_stamped(folder / "depth.txt") : std::vector<Stamped>{};
  for (const Stamped& color : colors) {
    std::string name = fs::path(color.rest).stem().string();
    // time stamps hold a dot, which other tools take for the extension
    std::replace(name.begin(), name.end(), '.', '_');
    add_frame(capture, name, [&] {
      CapturedFrame frame;
      frame.name = name;
      frame.image = folder / color.rest;
      const Stamped* pose = nearest(poses, color.time);
      if (!pose) throw_bad_input(truth, "", "no pose within 0.02 s", "nothing, when tracking began later");
      if (const Stamped* depth = nearest(depths, color.time)) set_depth(frame, folder / depth->rest);
      std::istringstream words(pose->rest);
      Vec3d t;
      Quaterniond q;
      if (!(words >> t.x >> t.y >> t.z >> q.x >> q.y >> q.z >> q.w) || !(norm(q) > 0.5)) {
        throw_bad_input(truth, "time " + std::to_string(pose->time), "expected tx ty tz qx qy qz qw", "check the file");
      }
      frame.world_to_camera = Rigidd{rotation_matrix(normalized(q)), t}.inverse();
      set_intrinsics(frame, k[0], k[row + 1], k[2], k[row + 2]);
      return frame;
    });
  }
  return capture;
}

}  // namespace aligngs
