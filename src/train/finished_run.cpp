#include "train/finished_run.h"

#include <fmt/format.h>

#include "core/error.h"
#include "io/output_place.h"
#include "scene/scene.h"

namespace aligngs {

void refuse_other_scene(const std::filesystem::path& run, const std::filesystem::path& scene) {
  throw_bad_input(
      run, "scene",
      fmt::format("this run was trained on another scene than {}, or the scene has changed since", scene.string()),
      "give the scene the run began with, or start again with --overwrite");
}

void require_scene_of_finished(const TrainOptions& options, const RunRecord& record) {
  if (options.scene.empty() || record.fingerprint.empty()) return;
  if (real_place(options.scene) == real_place(scene_of_run(options.run, record))) return;
  Scene scene = open_scene(options.scene);
  leave_out_views(scene, record.left_out);
  if (scene_fingerprint(scene) != record.fingerprint) refuse_other_scene(options.run, options.scene);
}

TrainResult result_of_finished(const RunRecord& record) {
  TrainResult result;
  result.already_finished = true;
  result.iterations = record.train.iterations;
  result.gaussians = record.train.gaussians;
  result.seconds = record.train.seconds;
  result.warnings = record.warnings;
  return result;
}

}  // namespace aligngs
