#include "scene/import/capture_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <set>

#include "core/erase_marked.h"
#include "core/error.h"
#include "core/far_outliers.h"
#include "core/letter_case.h"
#include "io/file_system_error.h"
#include "io/image_file.h"
#include "io/text_encoding.h"
#include "io/unicode_letters.h"
#include "scene/import/capture_text.h"
#include "scene/lens_model.h"
#include "scene/photo_fit.h"
#include "scene/view_names.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> parts;
  for (const fs::path& part : fs::path(name).relative_path()) parts.push_back(part.string());
  return parts;
}

/// The parts in their common spelling (unicode_letters.h).
std::vector<std::string> spelled(std::vector<std::string> parts) {
  for (std::string& part : parts) part = common_spelling(part);
  return parts;
}

/// The last run of digits in a file's stem; -1 when there is none.
int number_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  size_t end = stem.size();
  const auto digit = [&](size_t i) { return std::isdigit(static_cast<unsigned char>(stem[i])) != 0; };
  while (end > 0 && !digit(end - 1)) --end;
  size_t begin = end;
  while (begin > 0 && digit(begin - 1)) --begin;
  int number = -1;
  std::from_chars(stem.data() + begin, stem.data() + end, number);
  return number;
}

void leave_out_repeated(Capture& capture) {
  std::map<fs::path, std::set<std::string>> cameras_of_photo;
  for (const CapturedFrame& frame : capture.frames) cameras_of_photo[frame.image].insert(frame.name);
  std::map<std::string, fs::path> seen;
  std::erase_if(capture.frames, [&](const CapturedFrame& frame) {
    if (cameras_of_photo[frame.image].size() > 1) {
      capture.left_out.push_back({frame.name,
                                  "several cameras name the photo " + as_utf8(frame.image.filename().string()),
                                  "give each photo one camera"});
      return true;
    }
    const auto [first, fresh] = seen.emplace(frame.name, frame.image);
    if (fresh) return false;
    const std::string file = as_utf8(frame.image.filename().string());
    const std::string namesake = as_utf8(first->second.filename().string());
    capture.left_out.push_back({frame.name,
                                first->second == frame.image
                                    ? "it is listed twice (" + file + ")"
                                    : "two images have this name before the last dot: " + namesake + " and " + file,
                                "rename or remove one of them"});
    return true;
  });
}

/// Whether a PNG of depth holds fewer than 16 bits; a file that is no picture is left to what reads it.
bool has_few_bits(const fs::path& file) {
  try {
    return read_image_info(file).bit_depth < 16;
  } catch (const Error&) {
    return false;
  }
}

/// Depth of 8 bits is the same for all frames of a capture, or an accident of single ones, which are left out later.
void leave_out_eight_bits(Capture& capture) {
  const auto eight = [](const CapturedFrame& frame) { return !frame.depth.empty() && has_few_bits(frame.depth); };
  if (capture.frames.empty() || !std::all_of(capture.frames.begin(), capture.frames.end(), eight)) return;
  capture.notes.emplace_back("depth is not used: it has 8 bits, as pictures of depth have, and so no unit");
  for (CapturedFrame& frame : capture.frames) frame.depth.clear();
}

/// A layout that has depth, and no frame with any: says where it is looked for, and what lies there.
void note_no_depth(Capture& capture) {
  const auto with = [](const CapturedFrame& frame) { return !frame.depth.empty(); };
  if (capture.depth_files.empty() || std::any_of(capture.frames.begin(), capture.frames.end(), with)) return;
  std::string note = "depth is not used: no frame has its " + capture.depth_files;
  const fs::path below = fs::path(capture.depth_files).parent_path(), place = capture.folder / below;
  const bool alone = !below.empty() && !capture.frames.empty() && capture.frames[0].image.parent_path() != place;
  std::set<std::string> others;
  std::error_code error;
  for (fs::directory_iterator entry(place, error), end; alone && !error && entry != end; entry.increment(error)) {
    if (!is_hidden(entry->path())) others.insert(as_utf8(entry->path().filename().string()));
  }
  if (!others.empty()) note += "; " + below.string() + " holds " + *others.begin();
  capture.notes.push_back(note);
}

/// A depth prior is of use when every training view has one.
void leave_out_without_depth(Capture& capture) {
  const auto without = [](const CapturedFrame& frame) { return frame.depth.empty(); };
  const auto missing = static_cast<size_t>(std::count_if(capture.frames.begin(), capture.frames.end(), without)),
             all = capture.frames.size();
  if (missing == 0 || missing == all) return;
  if (2 * missing > all) {
    capture.notes.push_back("only " + std::to_string(all - missing) + " of " + std::to_string(all) +
                            " frames have depth: none is used");
    for (CapturedFrame& frame : capture.frames) frame.depth.clear();
    return;
  }
  for (const CapturedFrame& frame : capture.frames) {
    if (without(frame))
      capture.left_out.push_back(
          {frame.name, "its depth is missing", "add the depth image, or remove the folder of depth to go without"});
  }
  std::erase_if(capture.frames, without);
}

/// Confidence that some frames have and others lack: low depth of the others is used.
void note_missing_confidence(Capture& capture) {
  size_t with = 0;
  std::vector<std::string> without;
  for (const CapturedFrame& frame : capture.frames) {
    if (frame.depth.empty()) continue;
    if (!frame.confidence.empty())
      ++with;
    else
      without.push_back(frame.name);
  }
  if (with == 0 || without.empty()) return;
  capture.notes.push_back(
      fmt::format("{} of {} frames with depth have no confidence, and all of their depth is used: {}{}", without.size(),
                  with + without.size(), without.front(), without.size() > 1 ? " and others" : ""));
}

void leave_out_far_cameras(Capture& capture) {
  std::vector<Vec3d> centres;
  for (const CapturedFrame& frame : capture.frames) centres.push_back(frame.world_to_camera.inverse().translation);
  const std::vector<bool> far = far_outliers(centres);
  for (size_t i = 0; i < far.size(); ++i) {
    if (far[i]) capture.left_out.push_back({capture.frames[i].name, kFarFromOthers, kFarFromOthersRemedy});
  }
  erase_marked(capture.frames, far);
}

}  // namespace

std::string note_of_unusable_points(size_t count) {
  return std::to_string(count) + " points without a usable position (not finite, or beyond all scenes) are not used";
}

void set_camera(CapturedFrame& frame, const ColmapCamera& camera, const fs::path& file) {
  lens_of(camera, file);
  const ImageInfo info = read_image_info(frame.image);
  const PhotoFit fit = require_photo_fit(frame.image, info, static_cast<int>(std::min<uint64_t>(camera.width, 1 << 30)),
                                         static_cast<int>(std::min<uint64_t>(camera.height, 1 << 30)));
  frame.upright = fit.upright;
  frame.camera = resized_camera(camera, fit.width, fit.height);
}

void set_intrinsics(CapturedFrame& frame, const Intrinsics& lens) {
  const ImageInfo info = read_image_info(frame.image);
  const int w = info.stored_width, h = info.stored_height;
  if (const std::string problem = misfit_of_intrinsics(lens.cx, lens.cy, w, h); !problem.empty()) {
    if (info.orientation >= kFirstQuarterTurn && misfit_of_intrinsics(lens.cx, lens.cy, h, w).empty())
      throw_bad_input(frame.image, "intrinsics", problem, kTurnedByExif);
    throw_bad_input(frame.image, "intrinsics", problem,
                    "the intrinsics are for other photos: scale them, or use the photos they belong to; cameras with "
                    "their size (transforms.json, COLMAP) may be of any kind");
  }
  frame.upright = false;
  frame.camera = pinhole_camera(lens.fx, lens.fy, lens.cx, lens.cy, w, h);
  lens_of(frame.camera, lens.file);
}

fs::path folder_called(const fs::path& folder, const std::string& name) {
  std::error_code error;
  if (fs::is_directory(folder / name, error)) return folder / name;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (lower_case(entry->path().filename().string()) == name && entry->is_directory(error)) return entry->path();
  }
  return folder / name;
}

fs::path file_if_there(const fs::path& file) {
  std::error_code error;
  if (fs::is_regular_file(file, error)) return file;
  if (error == std::errc::permission_denied) throw error_of(fs::filesystem_error("status", file, error));
  fs::path loud = file;
  loud.replace_extension(".PNG");
  return fs::is_regular_file(loud, error) ? loud : fs::path();
}

void set_depth(CapturedFrame& frame, const fs::path& file) { frame.depth = file_if_there(file); }

std::vector<int> poses_of_numbered(Capture& capture, const std::vector<fs::path>& photos, size_t poses,
                                   const fs::path& file) {
  if (poses == 0) throw_bad_input(file, "poses", "this file holds no pose", "give the poses of the photos");
  std::vector<int> indices;
  for (size_t i = 0; i < photos.size(); ++i) {
    int index = static_cast<int>(i);
    if (photos.size() != poses) {
      index = number_of(photos[i]);
      if (index < 0) {
        throw_bad_input(file, "poses",
                        "there are " + std::to_string(photos.size()) + " photos but " + std::to_string(poses) +
                            " poses, and " + as_utf8(photos[i].filename().string()) +
                            " has no number to tell which is its own",
                        "there must be a pose for each photo");
      }
    }
    indices.push_back(static_cast<size_t>(index) < poses ? index : -1);
  }
  const std::set<int> paired(indices.begin(), indices.end());
  for (size_t i = 0; i < poses && photos.size() != poses; ++i) {
    if (!paired.count(static_cast<int>(i)))
      capture.left_out.push_back({"pose " + std::to_string(i), PhotoLookup::kMissing, "add the photo"});
  }
  return indices;
}

FrameNames::FrameNames(const std::vector<CapturedFrame>& frames) {
  for (const CapturedFrame& frame : frames) {
    parts_.push_back(parts_of(frame.name));
    spelled_.push_back(spelled(parts_.back()));
  }
}

int FrameNames::find(const std::string& name) const {
  for (const std::string& wanted : {as_utf8(slashed_name(name)), view_name_of(name)}) {
    const std::vector<std::string> parts = parts_of(wanted);
    const auto exact = std::find(parts_.begin(), parts_.end(), parts);
    if (exact != parts_.end()) return static_cast<int>(exact - parts_.begin());
  }
  for (const std::string& wanted : {as_utf8(slashed_name(name)), view_name_of(name)}) {
    const std::vector<std::string> parts = parts_of(wanted);
    int found = -1, count = 0;
    size_t longest = 1;
    for (size_t i = 0; i < parts_.size(); ++i) {
      const size_t common = std::min(parts.size(), parts_[i].size());
      if (common < longest ||
          !std::equal(parts.rbegin(), parts.rbegin() + static_cast<ptrdiff_t>(common), parts_[i].rbegin()))
        continue;
      if (common > longest) count = 0;
      longest = common;
      found = static_cast<int>(i);
      ++count;
    }
    if (count == 1) return found;
  }
  if (const int found = by_spelling(name); found >= 0) return found;
  const std::string decoded = percent_decoded(name);
  return decoded.empty() ? -1 : find(decoded);
}

int FrameNames::by_spelling(const std::string& name) const {
  int found = -1;
  for (const std::string& wanted : {as_utf8(slashed_name(name)), view_name_of(name)}) {
    const std::vector<std::string> parts = spelled(parts_of(wanted));
    for (size_t i = 0; i < spelled_.size(); ++i) {
      if (spelled_[i] != parts || found == static_cast<int>(i)) continue;
      if (found >= 0) return -1;
      found = static_cast<int>(i);
    }
  }
  return found;
}

void shorten_names(Capture& capture) {
  std::vector<std::string> names;
  std::map<std::string, std::string> stems;  // of the first frame of a name: the second is listed twice
  for (const CapturedFrame& frame : capture.frames) {
    // A name may leave out the extension, and may hold dots: the file that was found says where it ends.
    const std::string stem = stems.try_emplace(frame.name, as_utf8(frame.image.stem().string())).first->second;
    names.push_back((fs::path(as_utf8(frame.name)).parent_path() / stem).generic_string());
  }
  const std::vector<std::string> shortened = without_shared_folders(names);
  for (size_t i = 0; i < names.size(); ++i) capture.frames[i].name = shortened[i];
}

void finish_capture(Capture& capture) {
  for (CapturedFrame& frame : capture.frames) frame.name = as_utf8(frame.name);
  leave_out_repeated(capture);
  leave_out_far_cameras(capture);
  note_no_depth(capture);
  leave_out_without_depth(capture);
  leave_out_eight_bits(capture);
  note_missing_confidence(capture);
  require_enough(capture.folder, capture.frames.size(), capture.left_out, 1, false);
  if (capture.frames.empty())
    throw_bad_input(capture.folder, "frames", "no frame is listed, or no photo is there",
                    "check the folder, its photos and its poses");
  place_near_origin(capture);
}

}  // namespace aligngs
