// The floor and the ceiling among the planes of everything, by what lies beyond them.
#pragma once

#include <optional>
#include <vector>

#include "refine/scene_planes.h"
#include "room/seen_points.h"

namespace aligngs {

/// Lengths as shares of the height between the lowest and the highest surfaces: the world may have no unit.
struct LevelPlaneSettings {
  double level_angle = 8;     ///< degrees from level
  double upright_angle = 12;  ///< degrees from upright from which a plane that faces down may be a sloping ceiling
  double on = 0.03;           ///< distance of points on a plane
  double beyond = 0.08;       ///< and from which they are beyond it
  /// points beyond a plane, as a share of those on it: stairs and yards lie below a floor. Photos of a table show as
  /// much of the floor below it.
  double most_beyond = 0.5;
  /// points on a plane, as a share of the largest one that faces the same way: furniture hides most of some floors
  double least_points = 0.1;
  double stray = 0.01;  ///< share of the heights on each side that are strays
};

/// Indices of planes. The frame has z up.
struct LevelPlanes {
  std::optional<size_t> floor;   ///< faces up below the cameras, with nearly nothing below it
  std::vector<size_t> ceilings;  ///< the level one if there is one, and sloping ones
  /// heights of the floor and of the level ceiling; without them of the lowest, and the highest surface or camera
  double low = 0, high = 0;
};

LevelPlanes find_level_planes(const std::vector<ScenePlane>& planes, const std::vector<SeenPoint>& points,
                              const LevelPlaneSettings& settings = {});

}  // namespace aligngs
