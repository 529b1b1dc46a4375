// A pinhole camera with its pose. OpenCV axes: x right, y down, z forward.
#pragma once

#include "core/rigid.h"

namespace aligngs {

/// Pixel i covers [i, i + 1) and its centre is i + 0.5. The principal point is in the same coordinates (COLMAP's
/// convention), so it is width / 2 for a centred camera.
struct Camera {
  int width = 0;          ///< pixels
  int height = 0;         ///< pixels
  double fx = 0, fy = 0;  ///< focal lengths, pixels
  double cx = 0, cy = 0;  ///< principal point, pixels
  Rigidd world_to_camera;

  Vec3d centre() const { return world_to_camera.inverse().translation; }
  /// Viewing direction (camera z axis) in the world, unit length.
  Vec3d forward() const { return world_to_camera.rotation.row(2); }
  /// Ray of image point (u, v) in the camera frame with z = 1; pixel (x, y) is (x + 0.5, y + 0.5).
  Vec3d ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1}; }
  /// Image point of a camera-frame point with z > 0.
  Vec2d project(const Vec3d& p) const { return {fx * p.x / p.z + cx, fy * p.y / p.z + cy}; }
  bool contains(const Vec2d& p) const { return p.x >= 0 && p.y >= 0 && p.x < width && p.y < height; }
  /// World point of image point (u, v) at camera-frame depth z.
  Vec3d unproject(double u, double v, double z) const { return world_to_camera.inverse() * (ray(u, v) * z); }
  /// The same camera for an image resized to w x h.
  Camera resized(int w, int h) const {
    Camera c = *this;
    const double sx = static_cast<double>(w) / width, sy = static_cast<double>(h) / height;
    c.width = w;
    c.height = h;
    c.fx *= sx;
    c.cx *= sx;
    c.fy *= sy;
    c.cy *= sy;
    return c;
  }
};

}  // namespace aligngs
