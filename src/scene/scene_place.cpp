#include "scene/scene_place.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "io/output_place.h"
#include "scene/scene_json.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

nlohmann::ordered_json description_of(const fs::path& folder) {
  const fs::path file = folder / "scene.json";
  return fs::is_regular_file(file) ? parse_ordered_json(read_file(file, kMaxSceneFile))
                                   : nlohmann::ordered_json::object();
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

}  // namespace aligngs
