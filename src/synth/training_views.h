// Training views: a walk through the free space, and directions that show most of the surface twice.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/view_planner.h"

namespace aligngs {

/// A place of the walk and the view that was chosen there.
struct Station {
  Vec3d eye;
  std::vector<uint8_t> visible;  ///< per surface point: seen from here, in some direction
  Camera camera;
  std::vector<uint32_t> seen;  ///< indices of points in the chosen view
};

/// Draws from the planner's random numbers.
std::vector<Station> plan_training(ViewPlanner& planner);

}  // namespace aligngs
