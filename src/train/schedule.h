// Plan of each iteration of a run: settings and facts about scene and start in, numbers for one step out.
#pragma once

#include <cstdint>

#include "engine/settings.h"
#include "gaussians/density_control.h"
#include "gaussians/mcmc_growth.h"
#include "train/config.h"
#include "train/loss_schedule.h"
#include "train/pose_refinement.h"

namespace aligngs {

/// Use of pred_depths/.
enum class PriorDepthKind {
  kNone,
  kMetric,   ///< in scene units, as made or as placed (scene/depth_placement.h): start, L_z, prior normals, free space
  kRelative  ///< only its correlation with the rendered depth (L_d)
};

/// The facts that a plan depends on. They are part of a run's state (TrainingState in checkpoint.h).
struct TrainingFacts {
  // Facts of the scene: a run that goes on finds them again.
  int training_views = 1;
  int image_side = 0;  ///< pixels along the larger side of the largest training image
  PriorDepthKind prior_depth = PriorDepthKind::kNone;
  bool network_cameras = false;  ///< a network estimated cameras and depth: both are some percent off
  bool semantics = false;
  float extent = 1;  ///< robust scene extent, scene units
  // Facts of the start: checkpoints keep them.
  bool dense_start = false;       ///< the Gaussians started from prior depth
  bool normals_at_start = false;  ///< so plane depth means something from the first step
  uint64_t max_gaussians = 0;     ///< cap of density control; 0 = none
};

/// Iterations are 1-based. Iteration keys are scaled by schedule length / train.reference_iterations and rounded. All
/// rates and weights reach their end values at the schedule's length and stay there. An extended run hence continues
/// with the end values. (The paper's release decays positions over 30000 iterations and stops at 7000. Here the decay
/// always ends with the run.)
class Schedule {
 public:
  Schedule(const TrainConfig& config, const TrainingFacts& facts);

  /// Everything but `view`, its neighbour and its prior depth scale.
  StepRequest request(int64_t iteration) const;

  /// After the step of this iteration. Only the closed room follows the last step of a run: other rows that no step has
  /// touched do not belong in its result.
  bool densifies(int64_t iteration) const;
  /// Never so close to the end that the opacity could not recover: opacity_recovery() steps remain at least. Short runs
  /// have no reset.
  bool resets_opacity(int64_t iteration) const;
  bool prunes_free_space(int64_t iteration) const;
  bool raises_scales(int64_t iteration) const;
  bool aligns_prior_depth(int64_t iteration) const;
  bool fits_planes(int64_t iteration) const;
  /// After the last step.
  bool closes_room(int64_t iteration) const;
  /// the photos' votes take the place of the semantic rows (train/photo_labels.h)
  bool names_objects(int64_t iteration) const;
  /// Before the step of this iteration.
  bool lifts_semantics(int64_t iteration) const;

  /// Resolution of the views in the step of this iteration / working resolution. A function of the settings alone, so
  /// that a resumed run sees the same views.
  double view_scale(int64_t iteration) const;

  /// Rates of the training cameras in the step of this iteration.
  PoseRates pose_rates(int64_t iteration) const;

  /// Share of the Gaussians that the step of this iteration leaves out.
  double opacity_dropout(int64_t iteration) const;

  DensityRule density_rule(int64_t iteration) const;
  /// densify.strategy is mcmc: McmcRule instead of DensityRule, and noise after every step.
  bool uses_mcmc() const { return config_.densify.enabled && config_.densify.strategy == GrowthStrategy::kMcmc; }
  McmcRule mcmc_rule() const;
  /// Value for the step of this iteration; 0 without mcmc.
  double position_noise(int64_t iteration) const;
  int64_t iterations() const { return config_.train.iterations; }
  /// Steps in which an opacity that was reset surely grows to that of a surface; 272 at a rate of 0.05.
  int64_t opacity_recovery() const;

 private:
  int64_t scaled(int64_t reference_iterations) const;
  /// Like scaled, but a stop at or behind the reference length means "never".
  int64_t scaled_stop(int64_t reference_iterations) const;
  bool every(int64_t iteration, int64_t reference_interval) const;
  double share(int64_t iteration) const;  ///< of the schedule that is over, in (0, 1]
  LossSettings losses(int64_t iteration) const;
  LearningRates rates(int64_t iteration) const;

  TrainConfig config_;
  TrainingFacts facts_;
  int64_t length_;  ///< of the schedules, iterations
};

/// Opacity that a reset leaves at most (3DGS).
inline constexpr float kResetOpacity = 0.01f;

}  // namespace aligngs
