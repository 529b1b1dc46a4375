// Values of a camera that projection needs, and the integer ranges of pixels and tiles.
#pragma once

#include <cstdint>

#include "engine/settings.h"
#include "scene/camera.h"

namespace aligngs {

inline constexpr int kTileSize = 16;  ///< pixels; the edge of the square that is blended as one unit

/// x - x is 0 for every finite x and NaN otherwise.
template <class T>
ALIGNGS_HD inline bool is_finite(T x) {
  return x - x == T(0);
}
template <class T>
ALIGNGS_HD inline bool is_finite(const Vec3<T>& v) {
  return is_finite(v.x) && is_finite(v.y) && is_finite(v.z);
}
template <class T>
ALIGNGS_HD inline T clamp_to(T x, T low, T high) {
  return x < low ? low : (x > high ? high : x);
}

/// Values of a camera that projection needs, computed once per view.
template <class T>
struct ProjectionCamera {
  int width = 0, height = 0;  ///< pixels
  T fx{}, fy{}, cx{}, cy{};   ///< pixels; pixel i has its centre at i + 0.5
  Mat3<T> rotation;           ///< world to camera
  Vec3<T> translation;
  Vec3<T> centre;                  ///< in the world
  T slope_x_min{}, slope_x_max{};  ///< t_x / t_z in the Jacobian is clamped to this (guard band)
  T slope_y_min{}, slope_y_max{};

  /// Ray of the centre of pixel (x, y) in the camera frame, z = 1.
  ALIGNGS_HD Vec3<T> ray(int x, int y) const { return {(T(x) + T(0.5) - cx) / fx, (T(y) + T(0.5) - cy) / fy, T(1)}; }
};

/// The guard band is the image's own range of slopes, (0 - cx)/fx .. (W - cx)/fx, widened about its middle by
/// settings.guard_band. It is +-1.3 tan(FoV/2) of 3DGS when the principal point is central.
template <class T>
inline ProjectionCamera<T> make_projection_camera(const Camera& camera, const RasterSettings& settings) {
  ProjectionCamera<T> c;
  c.width = camera.width;
  c.height = camera.height;
  c.fx = T(camera.fx);
  c.fy = T(camera.fy);
  c.cx = T(camera.cx);
  c.cy = T(camera.cy);
  c.rotation = camera.world_to_camera.rotation.template cast<T>();
  c.translation = camera.world_to_camera.translation.template cast<T>();
  c.centre = camera.centre().template cast<T>();
  const double half_x = 0.5 * camera.width / camera.fx, middle_x = half_x - camera.cx / camera.fx;
  const double half_y = 0.5 * camera.height / camera.fy, middle_y = half_y - camera.cy / camera.fy;
  const double guard = settings.guard_band;
  c.slope_x_min = T(middle_x - guard * half_x);
  c.slope_x_max = T(middle_x + guard * half_x);
  c.slope_y_min = T(middle_y - guard * half_y);
  c.slope_y_max = T(middle_y + guard * half_y);
  return c;
}

/// Half-open range of pixels or tiles: x0 <= x < x1, y0 <= y < y1.
struct IntegerRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  ALIGNGS_HD bool empty() const { return x1 <= x0 || y1 <= y0; }
  ALIGNGS_HD int64_t area() const { return empty() ? 0 : int64_t(x1 - x0) * (y1 - y0); }
};

/// The tiles that a range of pixels touches.
ALIGNGS_HD inline IntegerRect tiles_of(const IntegerRect& pixels) {
  if (pixels.empty()) return {};
  return {pixels.x0 / kTileSize, pixels.y0 / kTileSize, (pixels.x1 + kTileSize - 1) / kTileSize,
          (pixels.y1 + kTileSize - 1) / kTileSize};
}

}  // namespace aligngs
