// Does a test view lie between the training views, or beyond them?
#pragma once

#include <vector>

#include "scene/camera.h"

namespace aligngs {

/// How far a view is from the training view that is most like it.
struct ViewNovelty {
  double distance = 0;  ///< to the nearest training camera's centre, scene units; infinite without training views
  double degrees = 0;   ///< between viewing directions, the smallest over the training cameras; 180 without
};
ViewNovelty view_novelty(const Camera& view, const std::vector<Camera>& training);

inline constexpr double kExtrapolationMetres = 0.5;  ///< at least so far from every training camera, or ...
inline constexpr double kExtrapolationDegrees = 30;  ///< ... turned at least so far: the view extrapolates

/// `metres_per_unit` is 1 for a metric scene.
inline bool extrapolates(const ViewNovelty& novelty, double metres_per_unit) {
  return novelty.distance * metres_per_unit >= kExtrapolationMetres || novelty.degrees >= kExtrapolationDegrees;
}

}  // namespace aligngs
