// TUM RGB-D: rgb.txt and depth.txt ("timestamp file" lines), groundtruth.txt ("timestamp tx ty tz qx qy qz qw",
// camera-to-world, OpenCV axes). Depth values are 1/5000 m. Times are matched within 0.02 s. Its calibrations count from
// the centre of the first pixel (319.5 is the middle of 640), so half a pixel is added.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/text_encoding.h"
#include "io/text_tokens.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/intrinsics.h"
#include "scene/photo_lookup.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr double kAssociationSeconds = 0.02;  // the data set's own rule
constexpr double kDepthUnit = 1.0 / 5000;     // metres per stored value
constexpr double kHalfPixel = 0.5;            // integer-centre convention of its calibrations to the corner convention

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
    const std::string_view content = trimmed(line);  // blank lines may hold the line end of Windows
    if (content.empty() || content[0] == '#') continue;
    std::istringstream words{std::string(content)};
    Stamped entry;
    const bool header = number == 1 && std::isalpha(static_cast<unsigned char>(content[0]));  // of a spreadsheet
    if (header) continue;
    if (!(words >> entry.time))
      throw_bad_input(file, "line " + std::to_string(number), "expected a time stamp", "lines are \"time value...\"");
    if (words.peek() == ',') words.get();
    std::getline(words >> std::ws, entry.rest);
    lines.push_back(entry);
  }
  return lines;
}

/// Numbers with commas between them, as spreadsheets write them, with blanks.
std::string with_blanks(std::string numbers) {
  std::replace(numbers.begin(), numbers.end(), ',', ' ');
  return numbers;
}

void sort_by_time(std::vector<Stamped>& lines) {
  std::stable_sort(lines.begin(), lines.end(), [](const Stamped& a, const Stamped& b) { return a.time < b.time; });
}

/// Among `lines` in the order of time; of equal ones the first.
const Stamped* nearest(const std::vector<Stamped>& lines, double time) {
  const auto first_from = [&](double from) {
    return std::lower_bound(lines.begin(), lines.end(), from, [](const Stamped& s, double t) { return s.time < t; });
  };
  const auto after = first_from(time);
  const Stamped* best = after == lines.end() ? nullptr : &*after;
  if (after != lines.begin()) {
    const Stamped& before = *first_from(std::prev(after)->time);
    if (!best || time - before.time <= best->time - time) best = &before;
  }
  return best && std::fabs(best->time - time) <= kAssociationSeconds ? best : nullptr;
}

/// Times in other units or of other clocks leave every photo without a pose.
void require_common_times(const std::vector<Stamped>& colors, const fs::path& color_file,
                          const std::vector<Stamped>& poses, const fs::path& truth) {
  if (colors.empty()) throw_bad_input(color_file, "lines", "this list names no photo", "lines are \"time file\"");
  if (poses.empty())
    throw_bad_input(truth, "lines", "this list has no pose", "lines are \"time tx ty tz qx qy qz qw\"");
  const auto earlier = [](const Stamped& a, const Stamped& b) { return a.time < b.time; };
  const auto [first, last] = std::minmax_element(colors.begin(), colors.end(), earlier);
  const double begin = poses.front().time - kAssociationSeconds, end = poses.back().time + kAssociationSeconds;
  if (first->time <= end && last->time >= begin) return;
  throw_bad_input(
      truth, "times",
      fmt::format("the poses are of {:.10g} to {:.10g}, the photos of {:.10g} to {:.10g}: no time is common",
                  poses.front().time, poses.back().time, first->time, last->time),
      "write both in seconds of the same clock");
}

}  // namespace

Capture read_tum(const fs::path& folder, const CaptureOptions& options) {
  if (options.intrinsics.empty()) {
    throw_bad_input(folder, "intrinsics", "TUM sequences do not carry their intrinsics",
                    "give --intrinsics FILE with fx fy cx cy or the 3x3 matrix (freiburg1: 517.3 516.5 318.6 255.3)");
  }
  Intrinsics lens = read_intrinsics(options.intrinsics);
  lens.cx += kHalfPixel;
  lens.cy += kHalfPixel;
  Capture capture;
  capture.folder = folder;
  capture.metric = true;
  capture.depth_unit = kDepthUnit;
  capture.depth_files = "file of depth.txt";
  const fs::path truth = folder / "groundtruth.txt";
  const std::vector<Stamped> colors = read_stamped(folder / "rgb.txt");
  std::vector<Stamped> poses = read_stamped(truth);
  std::vector<Stamped> depths =
      fs::exists(folder / "depth.txt") ? read_stamped(folder / "depth.txt") : std::vector<Stamped>{};
  sort_by_time(poses);
  sort_by_time(depths);
  require_common_times(colors, folder / "rgb.txt", poses, truth);
  const PhotoLookup files({}, folder);
  for (const Stamped& color : colors) {
    const std::string path = slashed_name(color.rest);
    std::string name = fs::path(path).stem().string();
    // time stamps hold a dot, which other tools take for the extension
    std::replace(name.begin(), name.end(), '.', '_');
    add_frame(capture, name, [&] {
      CapturedFrame frame;
      frame.name = name;
      const PhotoLookup::Answer photo = files.find(path);
      if (photo.file.empty()) throw_bad_input({}, "", photo.problem, "put the photo where rgb.txt says");
      frame.image = photo.file;
      const Stamped* pose = nearest(poses, color.time);
      if (!pose) throw_bad_input(truth, "", "no pose within 0.02 s", "add its pose, unless tracking was lost there");
      if (const Stamped* depth = nearest(depths, color.time))
        set_depth(frame, files.find(slashed_name(depth->rest)).file);
      std::istringstream words(with_blanks(pose->rest));
      Vec3d t;
      Quaterniond q;
      if (!(words >> t.x >> t.y >> t.z >> q.x >> q.y >> q.z >> q.w) || !(norm(q) > 0.5)) {
        throw_bad_input(truth, "time " + std::to_string(pose->time), "expected tx ty tz qx qy qz qw",
                        "write seven finite numbers, or leave this frame out");
      }
      frame.world_to_camera = Rigidd{rotation_matrix(normalized(q)), t}.inverse();
      set_intrinsics(frame, lens);
      return frame;
    });
  }
  return capture;
}

}  // namespace aligngs
