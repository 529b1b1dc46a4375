// The training views of a scene, loaded, and what may be used of their priors.
#pragma once

#include <string>
#include <vector>

#include "core/memory_budget.h"
#include "core/thread_pool.h"
#include "engine/training_view.h"
#include "scene/depth_placement.h"
#include "scene/scene.h"
#include "train/config.h"
#include "train/schedule.h"

namespace aligngs {

/// Usable priors of a run, decided from the scene and the settings before any photo is loaded.
struct PriorUse {
  PriorDepthKind depth = PriorDepthKind::kNone;
  bool semantics = false;
  DepthPlacement placement;           ///< of metric prior depth, in the order of Scene::train; no views otherwise
  std::vector<std::string> warnings;  ///< one sentence per prior that training goes without
  std::string depth_note;             ///< how prior depth is used, and why; empty without any

  /// Prior depth of a training view is multiplied by it; 1 where the view is not placed.
  double depth_factor(size_t training_view) const;
  /// The view has metric depth whose scale only the rendered scene can tell (PriorScales::free of scene_maintenance.h).
  bool is_unplaced(size_t training_view) const;
};

/// The warning of a scene without class scores.
inline constexpr const char* kWithoutLabels =
    "not every training view has semantics (segmentation_logits/): training goes on without labels";

/// Prior depth in scene units is metric. Depth of another scale is metric if it fits the scene's points to 5 %, or,
/// without points, itself between views to 20 %. Otherwise only its correlation with the rendered depth is used. Reads
/// the maps of depth that is not in scene units. Error{kBadInput} naming a file that cannot be read.
PriorUse decide_prior_use(const Scene& scene, const TrainConfig& config);

/// Checks shape and aspect of every pred_confidence/<view>.npy that a run will read. Error{kBadInput}.
void check_prior_confidence(const Scene& scene, const TrainConfig& config, const PriorUse& use);

/// Training views as the engine wants them, all maps at the working resolution. Loaded in parallel.
/// Error{kBadInput} naming the file.
std::vector<TrainingView> load_training_views(const Scene& scene, const TrainConfig& config, const PriorUse& use,
                                              ThreadPool& pool);

/// Bytes that load_training_views will take, from sizes and headers alone.
uint64_t predicted_view_bytes(const Scene& scene, const TrainConfig& config, const PriorUse& use);

/// Camera of a view at the working resolution.
Camera working_camera(const Scene& scene, const TrainConfig& config, int view);

/// Data of a view for maintenance between the steps, after the engine has taken it.
struct GuideView {
  std::string name;
  Camera camera;
  ImageF prior_depth;    ///< empty unless the prior is metric
  ImageF depth_weight;   ///< empty = 1
  float near_plane = 0;  ///< of this view, scene units
};
std::vector<GuideView> guides_of(const std::vector<TrainingView>& views, const PriorUse& use, const TrainConfig& config,
                                 double extent);

/// train.near_plane, or train.near_share of the nearest metric prior depth (its 1 % quantile; empty: none) where that
/// is farther. A camera whose estimated pose lies behind a wall would otherwise see nothing but that wall.
float near_plane_of(const ImageF& prior_depth, const TrainConfig& config, double extent);

/// The near plane with which training rendered this view, for stages that render it again. The prior depth is read when
/// the settings ask for it. A view that is no training view has the scene's near plane.
float near_plane_of_view(const Scene& scene, const TrainConfig& config, const PriorUse& use, int view);

/// Metric prior depth of a training view at the working resolution, scene units. Empty where the view has none, or none
/// whose scale is known. Error{kBadInput} naming the file.
ImageF placed_prior_depth(const Scene& scene, const TrainConfig& config, const PriorUse& use, size_t training_view);

/// near_plane_of_view() of all training views, in their order.
std::vector<float> near_planes_of_training_views(const Scene& scene, const TrainConfig& config, const PriorUse& use,
                                                 ThreadPool& pool);

/// The most Gaussians a run may start with: init.max_gaussians and init.gaussians_per_pixel of the largest view.
int64_t start_limit(const TrainConfig& config, size_t largest_view_pixels);

}  // namespace aligngs
