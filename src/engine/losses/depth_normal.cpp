#include "engine/losses/depth_normal.h"

#include <cmath>

namespace aligngs {
namespace {

Difference difference_of(bool before, bool after) {
  if (before && after) return Difference::kCentral;
  if (after) return Difference::kForward;
  return before ? Difference::kBackward : Difference::kNone;
}

}  // namespace

template <class T>
DepthStencil depth_stencil(const MapLossWorkspace<T>& workspace, int x, int y, int width, int height,
                           bool as_printed) {
  const size_t centre = static_cast<size_t>(y) * width + x;
  const uint8_t least = as_printed ? kDepthLoose : kDepthTight;
  if (workspace.validity[centre] < least) return {};
  const T z = workspace.depth[centre];
  const auto joined = [&](int nx, int ny) {
    if (nx < 0 || ny < 0 || nx >= width || ny >= height) return false;
    const size_t i = static_cast<size_t>(ny) * width + nx;
    if (workspace.validity[i] < least) return false;
    return as_printed || std::abs(workspace.depth[i] - z) <= T(kDepthJumpShare) * z;
  };
  DepthStencil stencil{difference_of(joined(x - 1, y), joined(x + 1, y)),
                       difference_of(joined(x, y - 1), joined(x, y + 1))};
  if (as_printed && (stencil.horizontal != Difference::kCentral || stencil.vertical != Difference::kCentral)) {
    return {};
  }
  return stencil;
}

template <class T>
DepthNormal<T> depth_normal(const MapLossWorkspace<T>& workspace, const Camera& camera, int x, int y,
                            DepthStencil stencil) {
  const int right = stencil.horizontal == Difference::kBackward ? x : x + 1;
  const int left = stencil.horizontal == Difference::kForward ? x : x - 1;
  const int bottom = stencil.vertical == Difference::kBackward ? y : y + 1;
  const int top = stencil.vertical == Difference::kForward ? y : y - 1;
  DepthNormal<T> n;
  const auto index = [&](int px, int py) { return static_cast<size_t>(py) * camera.width + px; };
  n.right = index(right, y);
  n.left = index(left, y);
  n.top = index(x, top);
  n.bottom = index(x, bottom);
  n.ray_right = pixel_ray<T>(camera, right, y);
  n.ray_left = pixel_ray<T>(camera, left, y);
  n.ray_top = pixel_ray<T>(camera, x, top);
  n.ray_bottom = pixel_ray<T>(camera, x, bottom);
  n.across = n.ray_right * workspace.depth[n.right] - n.ray_left * workspace.depth[n.left];
  n.up = n.ray_top * workspace.depth[n.top] - n.ray_bottom * workspace.depth[n.bottom];
  const Vec3<T> product = cross(n.across, n.up);
  const T length = norm(product);
  if (!(length > T(0)) || !std::isfinite(length)) return n;
  n.inverse_length = T(1) / length;
  n.turn = dot(product, pixel_ray<T>(camera, x, y)) > T(0) ? T(-1) : T(1);
  n.direction = product * (n.turn * n.inverse_length);
  return n;
}

template <class T>
void add_depth_normal_gradient(const DepthNormal<T>& n, const Vec3<T>& g, MapLossWorkspace<T>& workspace) {
  const Vec3<T> d_product = (g - n.direction * dot(g, n.direction)) * (n.inverse_length * n.turn);
  const Vec3<T> d_across = cross(n.up, d_product);   // of (a x b) . d by a
  const Vec3<T> d_up = cross(d_product, n.across);   // and by b
  workspace.depth_gradient[n.right] += dot(d_across, n.ray_right);
  workspace.depth_gradient[n.left] -= dot(d_across, n.ray_left);
  workspace.depth_gradient[n.top] += dot(d_up, n.ray_top);
  workspace.depth_gradient[n.bottom] -= dot(d_up, n.ray_bottom);
}

template DepthStencil depth_stencil<float>(const MapLossWorkspace<float>&, int, int, int, int, bool);
template DepthStencil depth_stencil<double>(const MapLossWorkspace<double>&, int, int, int, int, bool);
template DepthNormal<float> depth_normal<float>(const MapLossWorkspace<float>&, const Camera&, int, int, DepthStencil);
template DepthNormal<double> depth_normal<double>(const MapLossWorkspace<double>&, const Camera&, int, int,
                                                  DepthStencil);
template void add_depth_normal_gradient<float>(const DepthNormal<float>&, const Vec3<float>&,
                                               MapLossWorkspace<float>&);
template void add_depth_normal_gradient<double>(const DepthNormal<double>&, const Vec3<double>&,
                                                MapLossWorkspace<double>&);

}  // namespace aligngs
