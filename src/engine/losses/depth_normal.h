// The surface normal that a depth map implies, by differences of unprojected neighbours (aligngs.md 4.5).
#pragma once

#include <cmath>
#include <cstdint>

#include "engine/losses/depth_map.h"

namespace aligngs {

/// Which neighbours of a pixel stand for one axis of its difference.
enum class Difference : uint8_t { kNone = 0, kCentral = 1, kForward = 2, kBackward = 3 };

inline Difference difference_of(bool before, bool after) {
  if (before && after) return Difference::kCentral;
  if (after) return Difference::kForward;
  return before ? Difference::kBackward : Difference::kNone;
}

/// Horizontal and vertical difference of one pixel; a byte in workspace.stencil.
struct DepthStencil {
  Difference horizontal = Difference::kNone, vertical = Difference::kNone;
  bool valid() const { return horizontal != Difference::kNone && vertical != Difference::kNone; }
  bool central() const { return horizontal == Difference::kCentral && vertical == Difference::kCentral; }
  uint8_t packed() const { return static_cast<uint8_t>(int(horizontal) | int(vertical) << 2); }
  static DepthStencil unpack(uint8_t byte) {
    return {static_cast<Difference>(byte & 3), static_cast<Difference>(byte >> 2)};
  }
};

/// As printed: central differences wherever all five pixels have loose depth validity, so never on the border.
/// Default: tight validity; a one-sided difference where the neighbour on the other side is missing or lies
/// across a depth jump (|dz| / z > 5 %), none where both do.
template <class T>
DepthStencil depth_stencil(const MapLossWorkspace<T>& workspace, int x, int y, int width, int height,
                           bool as_printed) {
  const size_t centre = static_cast<size_t>(y) * width + x;
  const uint8_t least = as_printed ? kDepthLoose : kDepthTight;
  if (workspace.validity[centre] < least) return {};
  const T z = workspace.depth[centre];
  const auto joined = [&](size_t i) {
    return workspace.validity[i] >= least &&
           (as_printed || std::abs(workspace.depth[i] - z) <= T(kDepthJumpShare) * z);
  };
  const DepthStencil stencil{
      difference_of(x > 0 && joined(centre - 1), x + 1 < width && joined(centre + 1)),
      difference_of(y > 0 && joined(centre - width), y + 1 < height && joined(centre + width))};
  return as_printed && !stencil.central() ? DepthStencil{} : stencil;
}

/// (right - left) x (top - bottom) of the points that the stencil names, turned to the camera.
template <class T>
struct DepthNormal {
  Vec3<T> direction;     ///< unit
  T inverse_length = 0;  ///< of the cross product; 0 when it is too small or large for T
  T turn = 1;            ///< -1 when the cross product had to be turned to the camera
  size_t right = 0, left = 0, top = 0, bottom = 0;   ///< pixels used
  Vec3<T> ray_right, ray_left, ray_top, ray_bottom;  ///< their rays
  Vec3<T> across, up;                                ///< right - left, top - bottom
  bool valid() const { return inverse_length > T(0); }
};

template <class T>
DepthNormal<T> depth_normal(const MapLossWorkspace<T>& workspace, const PixelRays<T>& rays, int x, int y, int width,
                            DepthStencil stencil) {
  const int right = stencil.horizontal == Difference::kBackward ? x : x + 1;
  const int left = stencil.horizontal == Difference::kForward ? x : x - 1;
  const int bottom = stencil.vertical == Difference::kBackward ? y : y + 1;
  const int top = stencil.vertical == Difference::kForward ? y : y - 1;
  DepthNormal<T> n;
  const auto index = [&](int px, int py) { return static_cast<size_t>(py) * width + px; };
  n.right = index(right, y);
  n.left = index(left, y);
  n.top = index(x, top);
  n.bottom = index(x, bottom);
  n.ray_right = rays(right, y);
  n.ray_left = rays(left, y);
  n.ray_top = rays(x, top);
  n.ray_bottom = rays(x, bottom);
  n.across = n.ray_right * workspace.depth[n.right] - n.ray_left * workspace.depth[n.left];
  n.up = n.ray_top * workspace.depth[n.top] - n.ray_bottom * workspace.depth[n.bottom];
  const Vec3<T> product = cross(n.across, n.up);
  const T length = norm(product);
  if (!(length > T(0)) || !std::isfinite(length)) return n;
  n.inverse_length = T(1) / length;
  n.turn = dot(product, rays(x, y)) > T(0) ? T(-1) : T(1);
  n.direction = product * (n.turn * n.inverse_length);
  return n;
}

/// Adds dL / dz of the pixels used, given dL / d direction = g. Writes rows y - 1 .. y + 1.
template <class T>
void add_depth_normal_gradient(const DepthNormal<T>& n, const Vec3<T>& g, MapLossWorkspace<T>& workspace) {
  const Vec3<T> d_product = (g - n.direction * dot(g, n.direction)) * (n.inverse_length * n.turn);
  const Vec3<T> d_across = cross(n.up, d_product);  // (a x b) . d has the derivatives b x d by a
  const Vec3<T> d_up = cross(d_product, n.across);  // and d x a by b
  workspace.depth_gradient[n.right] += dot(d_across, n.ray_right);
  workspace.depth_gradient[n.left] -= dot(d_across, n.ray_left);
  workspace.depth_gradient[n.top] += dot(d_up, n.ray_top);
  workspace.depth_gradient[n.bottom] -= dot(d_up, n.ray_bottom);
}

}  // namespace aligngs
