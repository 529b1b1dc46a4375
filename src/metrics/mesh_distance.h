// Accuracy, completeness, precision, recall and F-score between two sets of surface points.
#pragma once

#include <cstddef>
#include <vector>

#include "core/thread_pool.h"
#include "core/vec.h"

namespace aligngs {

struct DistanceOptions {
  double threshold = 0.05;         ///< metres (units of the points); the field's 5 cm
  bool strict = true;              ///< distance < threshold counts (NeuRIS); false: <= (GO-Surf)
  std::vector<double> finer = {};  ///< metres: further thresholds, whose scores are in MeshScores::finer in this order
};

/// Precision, recall and F-score at one threshold (units of the points).
struct ThresholdScores {
  double threshold = 0, precision = 0, recall = 0, fscore = 0;
};

/// A number is NaN (JSON null) when there is nothing to measure it on; with no predicted point at all, recall and
/// fscore are 0.
struct MeshScores {
  double accuracy = 0;      ///< mean distance predicted -> truth, units of the points
  double completeness = 0;  ///< mean distance truth -> predicted
  double accuracy_median = 0, completeness_median = 0;
  double precision = 0;           ///< share of predicted points within the threshold of the truth
  double recall = 0;              ///< share of true points within the threshold of the prediction
  double fscore = 0;              ///< 2 P R / (P + R), 0 when both are 0
  double normal_consistency = 0;  ///< mean |n . n'| over both directions; NaN when normals were not given
  double threshold = 0;
  std::vector<ThresholdScores> finer;
  size_t predicted_points = 0, truth_points = 0;
};

/// Points with optional unit normals (empty, or one per point).
struct PointSet {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
};

MeshScores compare_points(const PointSet& predicted, const PointSet& truth, ThreadPool& pool,
                          const DistanceOptions& options = {});

}  // namespace aligngs
