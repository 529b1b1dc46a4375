#include "cli/stages/refine_stage.h"

#include <nlohmann/json.hpp>

#include "core/log.h"
#include "io/atomic_file.h"
#include "refine/refined_scene.h"

namespace aligngs {

namespace fs = std::filesystem;

fs::path refine_into_run(const fs::path& scene, const fs::path& run, const CommandContext& context) {
  const fs::path target = run / "scene";
  RefineSceneOptions options;
  options.overwrite = true;
  options.progress = context.progress();
  ThreadPool pool(context.global.threads);
  fs::create_directories(run);
  const RefineResult result = refine_scene(open_scene(scene), target, options, pool);
  log_info("cameras refined from {} tracks: reprojection error {:.2f} px before, {:.2f} px after, focal length x {:.3f}", result.tracks,
           result.bundle.start_median, result.bundle.end_median, result.focal_factor);
  return target;
}

bool is_refined(const fs::path& scene) {
  const fs::path file = scene / "scene.json";
  if (!fs::exists(file)) return false;
  const nlohmann::json json = nlohmann::json::parse(read_file(file), nullptr, false);
  return json.is_object() && json.contains("cameras_refined");
}

}  // namespace aligngs
