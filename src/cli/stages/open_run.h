// A run folder opened for the stages after training: its scene, its settings and an engine with its Gaussians.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "engine/engine.h"
#include "scene/scene.h"
#include "train/config.h"
#include "train/train_run.h"

namespace aligngs {

struct OpenRunOptions {
  std::filesystem::path scene;  ///< where the scene went, when it is not where run.json says; may be empty
  int threads = 0;
  EngineFactory make_engine = {};  ///< of the device to render on; empty: the CPU
};

struct OpenRun {
  std::filesystem::path folder;
  TrainConfig config;
  Scene scene;
  GaussianModel model;  ///< semantic rows as labels are drawn with them (semantic.drawn_sharpness)
  /// of all views: how a picture of the scene is exposed there; zeros without data.exposure
  std::vector<Vec3f> log_gains;
  std::unique_ptr<Engine> engine;
  std::unique_ptr<ThreadPool> pool;

  /// Frees the arrays of `model`: the engine has its own.
  void forget_model();
  bool has_labels() const { return model.semantic_channels > 0; }
  /// Camera of a view at the resolution at which the run worked.
  Camera working_camera(int view) const;
  LoadOptions load_options() const;  ///< pixels only, no priors
  RenderOptions render_options() const;
  /// As the camera of a view would have exposed it (scene/exposure_prediction.h).
  void expose_as(int view, ImageF& color) const;
};

/// Error{kBadInput} as read_trained_run() (train/trained_run.h) has it.
OpenRun open_run(const std::filesystem::path& folder, const OpenRunOptions& options);

}  // namespace aligngs
