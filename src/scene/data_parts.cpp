#include "scene/data_parts.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "core/letter_case.h"
#include "io/output_place.h"
#include "scene/import/capture.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr int kPathLevels = 4;  // folders above an output: a data set's deepest parts are D/colmap/sparse/0
constexpr std::array<std::string_view, 14> kParts = {"sparse",
                                                     "colmap",
                                                     "poses",
                                                     "pose",
                                                     "color",
                                                     "rgb",
                                                     "intrinsic",
                                                     "results",
                                                     "keyframes",
                                                     "masks",
                                                     "pred_depths",
                                                     "pred_confidence",
                                                     "segmentation_logits",
                                                     "segments"};

/// Folders that are still to come, or that cannot be read, are no data set.
bool is_data_set(const fs::path& folder) {
  std::error_code error;
  const fs::directory_iterator readable(folder, error);
  return !error && recognise_layout(folder) != nullptr;
}

}  // namespace

bool is_data_part(const std::string& name) {
  const std::string folder = lower_case(name);
  if (folder.starts_with("images") || folder.starts_with("depth") || folder.starts_with("seq-")) return true;
  return folder == "truth" || std::find(kParts.begin(), kParts.end(), folder) != kParts.end();
}

fs::path data_set_with_part(const fs::path& place) {
  const fs::path real = real_place(place);
  fs::path folder = real.parent_path();
  for (int level = 0; level < kPathLevels && folder != folder.parent_path(); ++level, folder = folder.parent_path()) {
    const std::string part = real.lexically_relative(folder).begin()->string();
    if (part == "results" && !fs::exists(folder / "traj.txt")) continue;  // photos of Replica; elsewhere a common name
    if (is_data_part(part) && is_data_set(folder)) return folder;
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
