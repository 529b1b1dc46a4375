// Iterative closest points: the similarity that moves one surface onto another, as a diagnostic.
#pragma once

#include <vector>

#include "core/rigid.h"
#include "core/thread_pool.h"
#include "metrics/mesh_distance.h"

namespace aligngs {

struct IcpOptions {
  /// Pairs farther apart than this do not count; one stage after the other (metres).
  std::vector<double> distances = {0.10, 0.05};
  int iterations = 40;  ///< at most, per stage
  bool with_scale = true;
  size_t max_points = 50'000;  ///< source points used; evenly strided when there are more
};

struct IcpReport {
  Similarity similarity;   ///< takes the source to the target
  double rmse_before = 0;  ///< root mean square point-to-plane distance of the pairs of the last stage, at the start
  double rmse_after = 0;   ///< the same at the end; NaN when there is no pair
  double inliers = 0;      ///< share of source points with a partner in the last stage at the end
  int iterations = 0;      ///< of all stages
  bool converged = false;  ///< the last stage stopped because the motion became negligible
};

/// Scaled point-to-plane ICP (Chen and Medioni 1991, with a seventh unknown for scale), Gauss-Newton steps.
/// Directions that the surface does not determine (a single plane: sliding, turning about its normal, scaling) are
/// left as they are. `target` needs normals. With no pair within reach the identity is returned, not converged.
IcpReport align_by_icp(const std::vector<Vec3f>& source, const PointSet& target, ThreadPool& pool,
                       const IcpOptions& options = {});

}  // namespace aligngs
