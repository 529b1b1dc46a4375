// The exact vertical of a room, from a rough one and the planes of everything in it.
#pragma once

#include <vector>

#include "refine/scene_planes.h"

namespace aligngs {

struct VerticalSettings {
  /// degrees from the rough direction within which the vertical is looked for: photos that look down tilt their mean up
  double search = 25;
  double agreement = 6;  ///< degrees from level or upright within which a plane is one
};

/// The normal near `up`, of either sign, that most points' planes are level or upright to. It is then the mean of the
/// level planes' normals. `up`, unit, where no plane has such a normal. Planes that are not finite are left out.
Vec3d vertical_near(const Vec3d& up, const std::vector<ScenePlane>& planes, const VerticalSettings& settings = {});

}  // namespace aligngs
