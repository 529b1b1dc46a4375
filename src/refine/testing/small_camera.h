// A camera for tests of poses.
#pragma once

#include "scene/camera.h"

namespace aligngs {

/// 320 x 240 pixels with 65 degrees across; at the origin, looking along z.
inline Camera small_camera() {
  Camera c;
  c.width = 320;
  c.height = 240;
  c.fx = c.fy = 250;
  c.cx = 160;
  c.cy = 120;
  return c;
}

}  // namespace aligngs
