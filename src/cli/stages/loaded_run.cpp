#include "cli/stages/loaded_run.h"

#include <utility>

#include "gaussians/drawn_labels.h"
#include "gaussians/shown_classes.h"
#include "scene/exposure_prediction.h"
#include "scene/view_data.h"
#include "train/config_file.h"
#include "train/schedule.h"
#include "train/training_set.h"

namespace aligngs {

namespace fs = std::filesystem;

void LoadedRun::forget_model() {
  GaussianModel shape;
  shape.semantic_channels = model.semantic_channels;
  shape.sh_degree = model.sh_degree;
  model = std::move(shape);
}

LoadOptions LoadedRun::load_options() const {
  LoadOptions options;
  options.scale = config().data.scale;
  options.prior_depth = false;
  options.semantics = false;
  return options;
}

RenderOptions LoadedRun::render_options() const {
  RenderOptions options;
  options.raster.near_plane = static_cast<float>(config().train.near_plane * robust_extent(scene()));
  options.semantic_blend = config().semantic.blend;
  options.labels = has_labels();
  return options;
}

const std::vector<float>& LoadedRun::near_planes() {
  if (near_planes_.empty()) {
    near_planes_ = near_planes_of_training_views(scene(), config(), decide_prior_use(scene(), config()), *pool);
  }
  return near_planes_;
}

void LoadedRun::expose_as(int view, ImageF& color) const {
  divide_exposure(log_gains[static_cast<size_t>(view)] * -1.0f, color);
}

LoadedRun load_run(const fs::path& folder, const LoadRunOptions& options) {
  OpenedRun opened = open_run(folder, options.scene);
  for (const std::string& assignment : options.sets) apply_config_set(assignment, opened.config);
  TrainingState state = read_trained_state(opened, CheckpointParts::kWithoutEngineArrays);
  place_cameras(opened, state);
  LoadedRun run;
  run.opened = std::make_shared<const OpenedRun>(std::move(opened));
  run.log_gains.resize(run.scene().views.size());
  if (run.config().data.exposure) run.log_gains = predict_log_gains(run.scene());
  run.model = std::move(state.engine.model);
  run.engine = options.make_engine ? options.make_engine(options.threads) : make_cpu_engine(options.threads);
  run.pool = std::make_unique<ThreadPool>(options.threads);
  const SemanticConfig& semantic = run.config().semantic;
  if (semantic.drawn_sharpness > 0 && semantic.blend == SemanticBlend::kProbabilities) {
    if (options.soft && options.soft->size() == run.model.size())
      sharpen_label_rows(run.model, *options.soft, semantic.drawn_sharpness, *run.pool);
    else
      sharpen_label_rows(run.model, robust_extent(run.scene()), semantic.drawn_sharpness, *run.pool);
  }
  if (options.shown_classes && semantic.blend == SemanticBlend::kProbabilities)
    run.classes = keep_shown_classes(run.model);
  run.engine->load(run.model);
  return run;
}

}  // namespace aligngs
