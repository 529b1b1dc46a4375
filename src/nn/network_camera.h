// A camera as networks predict it, or are given it.
#pragma once

#include <array>

namespace aligngs::nn {

/// OpenCV axes, no skew. The units of the translation are those of the network's depth.
struct NetworkCamera {
  std::array<double, 9> rotation{};       ///< row-major, world to camera
  std::array<double, 3> translation{};    ///< world to camera
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels of the network's input
};

}  // namespace aligngs::nn
