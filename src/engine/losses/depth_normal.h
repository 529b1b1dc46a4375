// The surface normal that a depth map implies, by differences of unprojected neighbours (aligngs.md 4.5).
#pragma once

#include <cstdint>

#include "core/vec.h"
#include "engine/losses/depth_map.h"

namespace aligngs {

/// Which neighbours of a pixel stand for one axis of its difference.
enum class Difference : uint8_t { kNone = 0, kCentral = 1, kForward = 2, kBackward = 3 };

/// Horizontal and vertical difference of one pixel; a byte in workspace.stencil.
struct DepthStencil {
  Difference horizontal = Difference::kNone, vertical = Difference::kNone;
  bool valid() const { return horizontal != Difference::kNone && vertical != Difference::kNone; }
  uint8_t packed() const { return static_cast<uint8_t>(int(horizontal) | int(vertical) << 2); }
  static DepthStencil unpack(uint8_t byte) {
    return {static_cast<Difference>(byte & 3), static_cast<Difference>(byte >> 2)};
  }
};

/// As printed: central differences wherever all five pixels have loose depth validity, so never on the border.
/// Default: tight validity; a one-sided difference where the neighbour on the other side is missing or lies
/// across a depth jump (|dz| / z > 5 %), none where both do.
template <class T>
DepthStencil depth_stencil(const MapLossWorkspace<T>& workspace, int x, int y, int width, int height, bool as_printed);

/// (right - left) x (top - bottom) of the points the stencil names, turned to the camera.
template <class T>
struct DepthNormal {
  Vec3<T> direction;     ///< unit
  T inverse_length = 0;  ///< of the cross product; 0 when the points lie on a line
  T turn = 1;            ///< -1 when the cross product had to be turned to the camera
  size_t right = 0, left = 0, top = 0, bottom = 0;                     ///< pixels used
  Vec3<T> ray_right, ray_left, ray_top, ray_bottom;                    ///< their rays
  Vec3<T> across, up;                                                  ///< right - left, top - bottom
  bool valid() const { return inverse_length > T(0); }
};

template <class T>
DepthNormal<T> depth_normal(const MapLossWorkspace<T>& workspace, const Camera& camera, int x, int y,
                            DepthStencil stencil);

/// Adds dL / dz of the pixels used, given dL / d direction = g. Writes rows y - 1 .. y + 1.
template <class T>
void add_depth_normal_gradient(const DepthNormal<T>& normal, const Vec3<T>& g, MapLossWorkspace<T>& workspace);

}  // namespace aligngs
