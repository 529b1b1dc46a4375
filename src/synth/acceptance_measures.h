// The measurements behind acceptance.h, one by one.
#pragma once

#include "synth/synth_scene.h"

namespace aligngs {

struct FusedPointFigures {
  double accuracy_mean = 0, accuracy_median = 0, completeness_mean = 0;  ///< metres
  double accuracy_on_cameras = 0;                                        ///< mean, aligned on training cameras alone
  double few_view_accuracy = 0, few_view_completeness = 0;               ///< means over groups of four views
};
FusedPointFigures measure_fused_points(const SynthScene& scene, ThreadPool& pool);

struct PoseFigures {
  double clipped_mean = 0, mean = 0;  ///< degrees
  double auc_30 = 1;                  ///< area under the share of pairs within an error, up to 30 degrees
  double focal = 0;                   ///< mean relative error
};
PoseFigures measure_pair_poses(const SynthScene& scene);

/// Spearman correlation between confidence and minus the error that a view has apart from the world's bend, mean over
/// training views. Confidence is blind to the bend.
double measure_confidence(const SynthScene& scene);

struct MonoFigures {
  double rmse = 0, pearson = 0;
};
MonoFigures measure_mono_depth(const SynthScene& scene);

struct SemanticFigures {
  double accuracy = 0, miou = 0, edge_accuracy = 0, persistent_share = 0;
};
SemanticFigures measure_semantics(const SynthScene& scene, ThreadPool& pool);

/// Panoptic quality of the segments of all views.
double measure_panoptic(const SynthScene& scene);

struct CoverageFigures {
  double test_seen = 1;   ///< of all test pixels with a surface, the smallest of all test views
  double seen_twice = 0;  ///< of the pixels of training views: seen by another training view as well
};
/// By reprojection of exact depth: a view sees a point when its own depth there agrees within 2 % + 2 cm.
CoverageFigures measure_coverage(const SynthScene& scene, ThreadPool& pool);

}  // namespace aligngs
