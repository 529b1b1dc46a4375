// Whether depth of several views contradicts their cameras, the points beside them, or the size of rooms.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/image.h"
#include "scene/camera.h"
#include "scene/point_cloud.h"

namespace aligngs {

struct DepthContradiction {
  std::string message;
  double factor = 1;  ///< depth times this agrees; 1: the unit is not the reason, or not known
};

/// The first that speaks against the depth: metres that no room has, depth far below the distances between the cameras,
/// or points at another distance. Else another unit, matrices or maps that are read wrongly, or views that contradict
/// each other (depth_agreement.h). Nothing where none does. `cameras[i]` has the size of `depths[i]`, where 0 is none.
std::optional<DepthContradiction> depth_contradiction(std::span<const Camera> cameras, std::span<const ImageF> depths,
                                                      const PointCloud& points, bool metric);

}  // namespace aligngs
