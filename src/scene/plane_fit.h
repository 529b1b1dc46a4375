// The plane through points with the least sum of squared distances.
#pragma once

#include <vector>

#include "core/vec.h"

namespace aligngs {

struct PlaneFit {
  Vec3d normal;  ///< unit: the direction in which the points vary least; of the two, the one nearer to `towards`
  Vec3d centre;  ///< weighted mean of the points, which lies in the plane
};

/// `weights` (>= 0, some > 0) has one number per point; empty: all weigh the same. At least one point. A turn of the
/// normal away from `towards`, a unit vector, costs `hold` times its squared sine; 0: nothing. With inverse variances as
/// weights, `hold` is the inverse variance of the turn in radians.
PlaneFit fit_plane(const std::vector<Vec3d>& points, const std::vector<double>& weights, const Vec3d& towards,
                   double hold = 0);

}  // namespace aligngs
