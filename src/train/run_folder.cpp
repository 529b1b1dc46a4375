#include "train/run_folder.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/abandoned_paths.h"
#include "io/file_system_error.h"
#include "io/folder_copy.h"
#include "io/output_place.h"
#include "io/text_encoding.h"
#include "scene/data_parts.h"
#include "train/replaceable_file.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// Files that a run writes into its folder; scene/, a possible input, is not in the list.
constexpr std::array<std::string_view, 24> kProducts = {
    "run.json",  "config.toml",  "events.ndjson", "checkpoints",  "scene.ply",       "scene.labels.ply",
    "scene.glb", "classes.json", "cameras.json",  "sparse",       "transforms.json", "mesh",
    "renders",   "metrics.json", "report.html",   "overview.jpg", "edits.json",      "edits",
    "log.txt",   "control",      "live",          "room.json",    "page.json",       "selections.json"};
constexpr std::string_view kExport = "scene.glb";  // the product that is an export, too
constexpr std::string_view kSceneFolder = "scene";

}  // namespace

bool RunFolder::has_run() const { return is_run_record(record()); }

bool RunFolder::wrote(const fs::path& file) const {
  return lies_within(file, folder_ / kSceneFolder) ||
         std::any_of(kProducts.begin(), kProducts.end(), [&](std::string_view product) {
           return product != kExport && lies_within(file, folder_ / product);
         });
}

void RunFolder::check(RunMode mode) const {
  std::error_code error;
  require_folder_place(folder_);
  require_outside_of_data(folder_);
  if (!fs::exists(folder_, error)) return;
  if (!fs::is_directory(folder_, error)) {
    throw Error({ErrorKind::kUsage, "the run folder is a file", folder_, "-o", "name a new folder"});
  }
  if (mode == RunMode::kNew && has_run()) {
    throw Error({ErrorKind::kUsage, "the folder already holds a run", folder_, "-o",
                 "use --resume to continue it, --overwrite to replace it, or name another folder"});
  }
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    // In a run folder people may keep notes of their own.
    if (has_run() || name == kSceneFolder || is_temporary_name(name)) continue;
    throw Error({ErrorKind::kUsage, "the folder is not empty and holds no run of aligngs, but " + as_utf8(name),
                 folder_, "-o", "name a new or empty folder"});
  }
}

void RunFolder::require_apart_from(const fs::path& source) const {
  bool apart = !lies_within(folder_, source);
  for (const std::string_view product : kProducts) apart = apart && !lies_within(source, folder_ / product);
  if (apart) return;
  throw Error({ErrorKind::kUsage,
               "a run here would write into its source (" + source.string() + "), which is never changed", folder_,
               "-o", "name a folder outside of the source"});
}

void RunFolder::require_not_of_run(const fs::path& file, const fs::path& scene, std::string_view own_beginning) const {
  std::vector<fs::path> owned;
  if (!scene.empty()) owned.push_back(scene);
  if (has_run()) {
    const RunRecord run = read_run_record(record());
    if (!run.scene.empty()) owned.push_back(scene_of_run(folder_, run));
  }
  const bool own = wrote(file) || std::any_of(owned.begin(), owned.end(),
                                              [&](const fs::path& place) { return lies_within(file, place); });
  if (!own) return require_replaceable(file, own_beginning);
  throw Error({ErrorKind::kUsage, "this file belongs to the run or to its scene: it is never replaced", file, "output",
               "name another file"});
}

/// A run whose removal would end half-way stays whole.
void RunFolder::require_removable() const {
  for (const std::string_view product : kProducts) {
    if (const fs::path place = first_protected_folder(folder_ / product); !place.empty())
      throw_resources(place, "this folder of the old run is protected against writing",
                      "let it be written (chmod -R u+w), or name another folder");
  }
}

void RunFolder::prepare(RunMode mode) const {
  check(mode);
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error)
    throw_resources(folder_, "the run folder cannot be created: " + error.message(), remedy_for_write(error.value()));
  if (mode == RunMode::kOverwrite) {
    require_removable();
    // run.json last: a folder that is cleared half-way is still recognised as a run's.
    for (auto product = kProducts.rbegin(); product != kProducts.rend(); ++product) {
      fs::remove_all(folder_ / *product, error);
      if (error) throw_resources(folder_ / *product, "the old run cannot be removed: " + error.message());
    }
  }
  remove_abandoned_in(folder_);
  remove_abandoned_in(checkpoints());
}

}  // namespace aligngs
