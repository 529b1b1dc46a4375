// Small corrections of the training cameras while the scene is trained.
#pragma once

#include <array>
#include <cstdint>

#include "core/rigid.h"
#include "engine/formulas/pose_gradient.h"

namespace aligngs {

/// How training has moved a camera, and the moments of Adam: a rotation vector (radians), then a translation (scene
/// units).
struct CameraMotion {
  std::array<double, 6> offset{}, m{}, v{};
  int64_t updates = 0;
};

/// Rates of one step; both 0: cameras do not move.
struct PoseRates {
  double rotation = 0;     ///< radians
  double translation = 0;  ///< scene units
  double decay = 0;        ///< share of its offset that a camera gives back at each update
  bool active() const { return rotation > 0 || translation > 0; }
};

/// exp(offset) base, world to camera.
Rigidd moved(const Rigidd& base, const CameraMotion& motion);

/// One step of Adam with decoupled decay. A gradient that is not finite changes nothing.
void update_motion(const PoseGradient<double>& gradient, const PoseRates& rates, CameraMotion& motion);

}  // namespace aligngs
