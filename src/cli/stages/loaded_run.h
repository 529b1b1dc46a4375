// An opened run on an engine, for the stages after training.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "engine/engine.h"
#include "gaussians/soft_labels.h"
#include "refine/plane_depth.h"
#include "scene/scene.h"
#include "train/config.h"
#include "train/opened_run.h"
#include "train/train_run.h"

namespace aligngs {

struct LoadRunOptions {
  std::filesystem::path scene;  ///< where the scene went, when it is not where run.json says; may be empty
  int threads = 0;
  EngineFactory make_engine = {};      ///< of the device to render on; empty: the CPU
  std::vector<std::string> sets = {};  ///< settings of the stage itself, e.g. "mesh.voxel=0.01"
  /// Semantic columns of the classes that a picture can show, alone (gaussians/shown_classes.h): a tenth of the memory.
  bool shown_classes = false;
  /// smoothed_labels() of the trained rows, for a caller that has them (TrainResult::soft); null: computed.
  std::shared_ptr<const SoftLabels> soft = {};
};

struct LoadedRun {
  SharedRun opened;               ///< cameras are placed
  GaussianModel model;            ///< semantic rows as labels are drawn with them (semantic.drawn_sharpness)
  std::vector<uint16_t> classes;  ///< of the semantic columns; empty: all classes
  /// of all views: how a picture of the scene is exposed there; zeros without data.exposure
  std::vector<Vec3f> log_gains;
  std::unique_ptr<Engine> engine;
  std::unique_ptr<ThreadPool> pool;
  /// The training views at their working size, as the mesh stage rendered them for the room stage; may be empty.
  std::vector<PlaneView> looks;

  const std::filesystem::path& folder() const { return opened->folder; }
  const TrainConfig& config() const { return opened->config; }
  const Scene& scene() const { return opened->scene; }
  /// Camera of a view at the resolution at which the run worked.
  Camera working_camera(int view) const { return opened->working_camera(view); }
  /// Near planes with which training rendered its views, in the order of scene().train. They are read once.
  const std::vector<float>& near_planes();
  /// Frees the arrays of `model`: the engine has its own.
  void forget_model();
  bool has_labels() const { return model.semantic_channels > 0; }
  LoadOptions load_options() const;  ///< pixels only, no priors
  RenderOptions render_options() const;
  /// As the camera of a view would have exposed it (scene/exposure_prediction.h).
  void expose_as(int view, ImageF& color) const;

 private:
  std::vector<float> near_planes_;  ///< empty until they are needed
};

/// Opens a run (open_run in train/opened_run.h), reads its newest checkpoint and loads it into an engine. Errors as
/// open_run's and read_trained_state's; Error{kUsage} for a setting that cannot be read.
LoadedRun load_run(const std::filesystem::path& folder, const LoadRunOptions& options);

}  // namespace aligngs
