#include "scene/not_a_scene.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/shell_word.h"
#include "io/atomic_file.h"
#include "io/colmap.h"
#include "io/json_text.h"
#include "scene/import/capture.h"
#include "scene/scene_json.h"

namespace aligngs {

namespace fs = std::filesystem;

void refuse_run_folder(const fs::path& folder, const fs::path& given) {
  const fs::path record = folder / "run.json";
  if (!fs::is_regular_file(record) || fs::exists(folder / "images")) return;
  const nlohmann::json run = parse_json(read_file(record, kMaxSceneFile));
  if (!run.is_object() || !run.contains("scene") || !run["scene"].is_string() || !run.contains("fingerprint")) return;
  const fs::path scene = (given / run["scene"].get<std::string>()).lexically_normal();
  throw_bad_input(folder, "run.json", "this is a run of aligngs, not a scene and no photos",
                  "give the scene that it was made from: " + quote_word(scene.string()));
}

void refuse_what_is_no_scene(const fs::path& folder, const fs::path& given) {
  refuse_run_folder(folder, given);
  if (may_hold_colmap_model(folder)) return;
  refuse_posed_capture(folder,
                       "turn it into a scene first: aligngs import " + quote_word(given.string()) + " -o SCENE");
  if (!fs::exists(folder / "transforms.json")) return;
  throw_bad_input(folder, "transforms.json", "this is a nerfstudio data set, not a scene yet",
                  "turn it into one first: aligngs import " + quote_word(given.string()) + " -o SCENE");
}

}  // namespace aligngs
