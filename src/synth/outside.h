// The view through a window: a garden and houses at their distances, so that it moves against the frame.
#pragma once

#include <cstdint>

#include "core/vec.h"

namespace aligngs {

/// All things are on vertical cylinders around the middle of the room; metres. The room lies one storey up.
struct OutsideSettings {
  double ground = -3;      ///< height of the lawn
  double near_radius = 9;  ///< bushes and trunks
  double middle_radius = 20;
  double far_radius = 45;  ///< houses
};

/// Colour seen along a ray that starts within near_radius of the axis x = y = 0. Room frame: z up, floor at z = 0.
/// Linear RGB in [0, 1], to be multiplied by the brightness of the day. `distance` (may be null) becomes the distance
/// in metres; the sky is infinitely far.
Vec3f outside_color(const Vec3d& origin, const Vec3d& direction, const OutsideSettings& settings, uint32_t seed,
                    double* distance = nullptr);

}  // namespace aligngs
