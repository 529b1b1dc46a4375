// The training loop: steps, maintenance, checkpoints, progress. One object per run.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/thread_pool.h"
#include "engine/engine.h"
#include "gaussians/placed_neighbours.h"
#include "scene/label_set.h"
#include "train/checkpoint.h"
#include "train/config.h"
#include "train/events.h"
#include "train/run_control.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/schedule.h"
#include "train/training_set.h"

namespace aligngs {

struct TrainerInputs {
  TrainConfig config;
  std::vector<GuideView> guides;  ///< one per training view, in the engine's order
  /// of every view, for the multi-view terms (neighbour_choice.h); empty: none
  std::vector<std::vector<int>> neighbours;
  /// views whose prior scale stays, or may become any (PriorScales of scene_maintenance.h)
  std::vector<uint8_t> known_scales, free_scales;
  LabelSet labels;             ///< of the scene, for live snapshots
  std::string fingerprint;     ///< of the scene
  std::string resume_command;  ///< shown when the run is interrupted
  ProgressStyle progress;
  /// The training views at this share of the working resolution; called when Schedule::view_scale changes and for new
  /// planes.
  std::function<std::vector<TrainingView>(double scale)> load_views;
};

/// Three non-finite steps end a run: one may be an accident, the third is a cause that will not go away.
inline constexpr int64_t kNonFiniteLimit = 3;

class Trainer {
 public:
  /// The engine already has the training views of the first step to come. References must outlive the trainer.
  Trainer(TrainerInputs inputs, Engine& engine, const RunFolder& folder, RunRecord& record, ThreadPool& pool);

  /// State before the first step of a new run whose engine holds the start model.
  TrainingState initial_state(const std::vector<float>& depth_scales, const TrainingFacts& facts) const;
  /// Runs from `state` (whose engine part is loaded when it holds a model) to config.train.iterations.
  /// Writes checkpoints, events and run.json on the way; the last iteration always has a checkpoint, and scene.ply before
  /// it where that checkpoint refers to it. The result's engine part is empty: the engine and that checkpoint hold it.
  /// Obeys the flags of run_control.h between steps; none of them changes the result.
  /// Error{kInterrupted} after a stop request, with a checkpoint written; Error{kFailed} when non-finite values repeat
  /// or no Gaussian is left, with a valid checkpoint.
  TrainingState run(TrainingState state);
  /// Neighbours of the Gaussians at the end, where objects were named in this process; else none.
  const PlacedNeighbours& neighbours() const { return neighbours_; }

 private:
  void iterate(int64_t iteration, EventLog& events);
  void handle_non_finite(const StepReport& report, int view, EventLog& events);
  void maintain_scene(int64_t iteration, EventLog& events);
  /// Puts the cameras where the state has them, in the engine and in the guides.
  void place_cameras();
  void place_camera(size_t view);
  void move_camera(size_t view, const PoseRates& rates);
  void close_room_now(int64_t iteration, EventLog& events);
  void name_objects_now(int64_t iteration, EventLog& events);
  void fit_planes_now(int64_t iteration, EventLog& events);
  /// Gives the engine the views of this resolution, with cameras and planes as the state has them.
  void give_views();
  RenderOptions labelled_rendering(int64_t iteration) const;
  void write_state();
  void stop_here();
  void obey();
  void obey_once();
  void publish_snapshot();
  void update_progress(const StepReport& report, Progress& progress) const;
  double seconds_since_start() const;

  TrainerInputs in_;
  Engine& engine_;
  const RunFolder& folder_;
  RunRecord& record_;
  ThreadPool& pool_;
  Schedule schedule_;
  std::vector<Rigidd> poses_;  ///< of the training cameras as the scene has them, world to camera
  ViewOrder order_;
  Random density_random_;
  TrainingState state_;
  StepReport report_;          ///< of the last step
  double view_scale_ = 1;      ///< of the views that the engine has
  int64_t checkpointed_ = -1;  ///< iteration of the newest checkpoint of this process
  double seconds_before_ = 0;  ///< training time of earlier processes
  int64_t iterations_before_ = 0;
  double begun_ = 0;  ///< steady clock, seconds
  RunControl control_;
  double look_at_ = 0;           ///< when to look for flags again, steady clock
  double snapshot_at_ = 0;       ///< when the next snapshot may be written
  PlacedNeighbours neighbours_;  ///< of name_objects_now
};

}  // namespace aligngs
