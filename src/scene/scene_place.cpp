#include "scene/scene_place.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.h"
#include "core/log.h"
#include "io/abandoned_paths.h"
#include "io/atomic_file.h"
#include "io/folder_copy.h"
#include "io/folder_replacement.h"
#include "io/json_text.h"
#include "io/output_place.h"
#include "scene/data_parts.h"
#include "scene/photo_mask.h"
#include "scene/scene_json.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

nlohmann::ordered_json description_of(const fs::path& folder) {
  const fs::path file = folder / "scene.json";
  return fs::is_regular_file(file) ? parse_ordered_json(read_file(file, kMaxSceneFile))
                                   : nlohmann::ordered_json::object();
}

/// The parts that this program writes into a scene (docs/formats.md, "Scene folder").
constexpr std::array<std::string_view, 13> kSceneEntries = {
    "images",   "masks",       "sparse",     "pred_depths", "pred_confidence", "segmentation_logits",
    "segments", "priors.json", "split.json", "scene.json",  "labels.csv",      "exposure.json",
    "truth"};

bool is_entry_of_scene(const std::string& name) {
  return std::find(kSceneEntries.begin(), kSceneEntries.end(), name) != kSceneEntries.end();
}

/// `from` is to exist at `to` as well: linked where the file system can do that.
void keep(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::remove_all(to, error);  // a copy of a source brought its own
  if (!error) link_folder(from, to, error);
  if (!error) return;
  fs::remove_all(to, error);
  if (!error) copy_folder(from, to, CopiedLinks::kKept, error);
  if (error)
    throw_resources(from, "this cannot be kept beside the new scene: " + error.message(),
                    "move it elsewhere, then run the same command again");
}

/// `masks.old`, or the first of `masks.old-2` and so on that is free in both folders.
std::string free_name_of_masks(const fs::path& a, const fs::path& b) {
  std::string name = "masks.old";
  for (int i = 2; fs::exists(a / name) || fs::exists(b / name); ++i) name = "masks.old-" + std::to_string(i);
  return name;
}

void keep_files_of_others(const fs::path& former, const fs::path& next) {
  if (!fs::is_directory(former)) return;
  std::string kept;
  for (const auto& entry : fs::directory_iterator(former)) {
    const std::string name = entry.path().filename().string();
    if (is_entry_of_scene(name) || is_temporary_name(name)) continue;
    keep(entry.path(), next / name);
    kept += (kept.empty() ? "" : ", ") + name;
  }
  if (!kept.empty()) log_info("{}: kept what aligngs did not write: {}", former.string(), kept);
  if (!fs::is_directory(former / kMaskFolder) || fs::exists(next / kMaskFolder)) return;
  const std::string name = free_name_of_masks(former, next);
  keep(former / kMaskFolder, next / name);
  log_warning("{}: the new scene has no masks; those of the former one are in {}/", former.string(), name);
}

}  // namespace

bool is_own_scene(const fs::path& folder) {
  const nlohmann::ordered_json json = description_of(folder);
  if (!json.is_object()) return false;
  const auto mark = json.find(kWrittenBy);
  return mark != json.end() && mark->is_string() && mark->get_ref<const std::string&>() == kThisProgram;
}

void mark_as_own(const fs::path& folder) {
  nlohmann::ordered_json json = description_of(folder);
  if (!json.is_object())
    throw_bad_input(folder / "scene.json", "", "a JSON object expected", "correct or remove the file");
  json[kWrittenBy] = kThisProgram;
  write_file_atomically(folder / "scene.json", json_document(json));
}

void require_scene_place(const fs::path& folder, bool overwrite, const std::vector<fs::path>& sources) {
  require_apart(folder, sources);
  const auto refuse = [&](const char* what, const char* remedy) {
    throw Error({ErrorKind::kUsage, what, folder, "output", remedy});
  };
  require_folder_place(folder);
  require_outside_of_data(folder);
  if (fs::is_symlink(folder) && !fs::exists(folder))
    refuse("this is a link to nothing", "choose another folder, or remove the link");
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) refuse("this is a file", "choose another folder");
  if (fs::is_empty(folder)) return;
  if (!is_own_scene(folder)) {
    refuse("this folder is not empty, and aligngs did not write it, as its scene.json shows: it is never replaced",
           "choose another folder, or remove this one yourself");
  }
  if (!overwrite)
    refuse("there is a scene already", "choose another folder, or add --overwrite to replace the scene in it");
}

void place_scene(FolderReplacement& replacement, bool overwrite, const std::vector<fs::path>& sources) {
  require_scene_place(replacement.target(), overwrite, sources);  // filled meanwhile?
  keep_files_of_others(replacement.target(), replacement.path());
  replacement.commit();
}

}  // namespace aligngs
