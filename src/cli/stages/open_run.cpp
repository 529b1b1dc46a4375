#include "cli/stages/open_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gaussians/drawn_labels.h"
#include "scene/exposure_prediction.h"
#include "scene/view_data.h"
#include "train/schedule.h"
#include "train/trained_run.h"

namespace aligngs {

namespace fs = std::filesystem;

Camera OpenRun::working_camera(int view) const {
  const Camera& camera = scene.views[view].camera;
  const double scale = config.data.scale;
  return camera.resized(std::max(1, static_cast<int>(std::lround(camera.width * scale))),
                        std::max(1, static_cast<int>(std::lround(camera.height * scale))));
}

void OpenRun::forget_model() {
  GaussianModel shape;
  shape.semantic_channels = model.semantic_channels;
  shape.sh_degree = model.sh_degree;
  model = std::move(shape);
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

void OpenRun::expose_as(int view, ImageF& color) const {
  divide_exposure(log_gains[static_cast<size_t>(view)] * -1.0f, color);
}

OpenRun open_run(const fs::path& folder, const OpenRunOptions& options) {
  TrainedRun trained = read_trained_run(folder, options.scene, CheckpointParts::kWithoutEngineArrays);
  OpenRun run;
  run.folder = folder;
  run.config = std::move(trained.config);
  run.scene = std::move(trained.scene);
  run.log_gains.resize(run.scene.views.size());
  if (run.config.data.exposure) run.log_gains = predict_log_gains(run.scene);
  run.model = std::move(trained.state.engine.model);
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
