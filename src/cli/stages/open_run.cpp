#include "cli/stages/open_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "gaussians/drawn_labels.h"
#include "scene/exposure_prediction.h"
#include "scene/view_data.h"
#include "train/checkpoint.h"
#include "train/config_file.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/schedule.h"

namespace aligngs {

namespace fs = std::filesystem;

Camera OpenRun::working_camera(int view) const {
  const Camera& camera = scene.views[view].camera;
  const double scale = config.data.scale;
  return camera.resized(std::max(1, static_cast<int>(std::lround(camera.width * scale))),
                        std::max(1, static_cast<int>(std::lround(camera.height * scale))));
}

LoadOptions OpenRun::load_options() const {
  LoadOptions options;
  options.scale = config.data.scale;
  options.prior_depth = false;
  options.semantics = false;
  return options;
}

RenderOptions OpenRun::render_options() const {
  RenderOptions options;
  options.raster.near_plane = static_cast<float>(config.train.near_plane * robust_extent(scene));
  options.semantic_blend = semantic_blend_named(config.semantic.blend);
  options.labels = has_labels();
  return options;
}

void OpenRun::expose_as(int view, ImageF& color) const { divide_exposure(log_gains[static_cast<size_t>(view)] * -1.0f, color); }

OpenRun open_run(const fs::path& folder, const OpenRunOptions& options) {
  const RunFolder paths(folder);
  if (!fs::exists(paths.record())) {
    throw_bad_input(folder, "run.json", "this is no run folder", "give a folder that `aligngs train` or `aligngs run` made");
  }
  OpenRun run;
  run.folder = folder;
  const RunRecord record = read_run_record(paths.record());
  apply_config_file(paths.config(), run.config);
  const fs::path scene_folder = scene_of_run(folder, record, options.scene);
  if (!fs::exists(scene_folder)) {
    throw_bad_input(scene_folder, "scene", "the scene of this run is not where run.json says", "say where it is now: --scene DIR");
  }
  run.scene = open_scene(scene_folder);
  const std::string fingerprint = scene_fingerprint(run.scene);
  if (!record.fingerprint.empty() && record.fingerprint != fingerprint) {
    log_warning("the scene in {} has changed since this run was trained", scene_folder.string());
  }
  std::optional<TrainingState> state = read_latest_checkpoint(paths.checkpoints(), record.fingerprint, CheckpointParts::kWithoutEngineArrays);
  if (!state) throw_bad_input(paths.checkpoints(), "", "nothing has been trained here yet", "run `aligngs train ... --resume` first");
  apply_motions(state->motions, run.scene);
  run.log_gains.resize(run.scene.views.size());
  if (run.config.data.exposure) run.log_gains = predict_log_gains(run.scene);
  run.model = std::move(state->engine.model);
  run.engine = options.make_engine ? options.make_engine(options.threads) : make_cpu_engine(options.threads);
  run.pool = std::make_unique<ThreadPool>(options.threads);
  const SemanticConfig& semantic = run.config.semantic;
  if (semantic.drawn_sharpness > 0 && semantic_blend_named(semantic.blend) == SemanticBlend::kProbabilities) {
    sharpen_label_rows(run.model, robust_extent(run.scene), semantic.drawn_sharpness, *run.pool);
  }
  run.engine->load(run.model);
  return run;
}

}  // namespace aligngs
