#include "scene/data_parts.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "core/letter_case.h"
#include "io/output_place.h"
#include "io/picture_format.h"
#include "scene/import/capture.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr int kPathLevels = 4;  // folders above an output: a data set's deepest parts are D/colmap/sparse/0
constexpr std::array<std::string_view, 22> kParts = {"images",
                                                     "depth",
                                                     "depths",
                                                     "depth_filtered",
                                                     "depth_with_noise",
                                                     "sparse",
                                                     "colmap",
                                                     "poses",
                                                     "pose",
                                                     "color",
                                                     "rgb",
                                                     "intrinsic",
                                                     "results",
                                                     "keyframes",
                                                     "masks",
                                                     "truth",
                                                     "pred_depths",
                                                     "pred_confidence",
                                                     "segmentation_logits",
                                                     "segments",
                                                     "resized_images",
                                                     "resized_undistorted_images"};

/// Whether `name` is `beginning` and a number, as images_4 and seq-01 are.
bool is_numbered(std::string_view name, std::string_view beginning) {
  if (!name.starts_with(beginning) || name.size() == beginning.size()) return false;
  name.remove_prefix(beginning.size());
  return std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Pictures that no run drew into its own folder.
bool holds_pictures(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "run.json", error)) return false;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string ending = lower_case(entry->path().extension().string());
    if (has_picture_extension(entry->path()) || ending == ".exr" || ending == ".npy" || ending == ".npz") return true;
  }
  return false;
}

/// Folders that are still to come, or that cannot be read, are no data set.
bool is_data_set(const fs::path& folder) {
  std::error_code error;
  const fs::directory_iterator readable(folder, error);
  return !error && recognise_layout(folder) != nullptr;
}

}  // namespace

bool is_data_part(const fs::path& folder) {
  const std::string name = lower_case(folder.filename().string());
  if (std::find(kParts.begin(), kParts.end(), name) != kParts.end()) return true;
  if (is_numbered(name, "images_") || is_numbered(name, "depths_") || is_numbered(name, "seq-")) return true;
  return (name.starts_with("images") || name.starts_with("depth")) && holds_pictures(folder);
}

fs::path data_set_with_part(const fs::path& place) {
  const fs::path real = real_place(place);
  fs::path folder = real.parent_path();
  for (int level = 0; level < kPathLevels && folder != folder.parent_path(); ++level, folder = folder.parent_path()) {
    const fs::path part = *real.lexically_relative(folder).begin();
    if (part == "results" && !fs::exists(folder / "traj.txt")) continue;  // photos of Replica; elsewhere a common name
    if (is_data_part(folder / part) && is_data_set(folder)) return folder;
  }
  return {};
}

void require_outside_of_data(const fs::path& folder) {
  const fs::path data = data_set_with_part(folder);
  if (data.empty()) return;
  throw Error({ErrorKind::kUsage,
               "this place belongs to the data set " + data.string() + ", which is a source and never changed", folder,
               "output", "choose a folder outside of the data set"});
}

}  // namespace aligngs
