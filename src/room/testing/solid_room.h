// Rooms of solid boxes, drawn in closed form: depth without any label.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "refine/testing/box_room.h"

namespace aligngs::solid_room {

// x right, y down, z forward; metres, the floor at y = 0.
struct SolidBox {
  Vec3d low, high;
};
using Solids = std::vector<SolidBox>;

inline constexpr double kHigh = 2.5, kThick = 0.2;

inline SolidBox box(double x0, double z0, double x1, double z1, double from, double to) {
  return {{x0, -to, z0}, {x1, -from, z1}};
}

/// Floor, ceiling and four walls around 0 <= x <= width, 0 <= z <= depth.
inline Solids empty_room(double width, double depth) {
  const double t = kThick;
  return {box(-t, -t, width + t, depth + t, -t, 0), box(-t, -t, width + t, depth + t, kHigh, kHigh + t),
          box(-t, -t, 0, depth + t, 0, kHigh),      box(width, -t, width + t, depth + t, 0, kHigh),
          box(-t, -t, width + t, 0, 0, kHigh),      box(-t, depth, width + t, depth + t, 0, kHigh)};
}

/// Depth along a ray with z = 1 until the first box from outside; 0 where there is none.
inline double depth_along(const Solids& solids, const Vec3d& origin, const Vec3d& ray) {
  double nearest = 1e30;
  for (const SolidBox& solid : solids) {
    double enter = -1e30, leave = 1e30;
    for (int k = 0; k < 3; ++k) {
      const double a = (solid.low[k] - origin[k]) / ray[k], b = (solid.high[k] - origin[k]) / ray[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter > 0 && enter < leave) nearest = std::min(nearest, enter);
  }
  return nearest < 1e30 ? nearest : 0;
}

/// The view of a camera, unlabelled.
inline PlaneView look(const Solids& solids, const Camera& camera) {
  PlaneView view;
  view.camera = camera;
  view.depth = ImageF(camera.width, camera.height, 1);
  const Mat3d to_world = transpose(camera.world_to_camera.rotation);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x)
      view.depth.at(x, y) =
          static_cast<float>(depth_along(solids, camera.centre(), to_world * camera.ray(x + 0.5, y + 0.5)));
  }
  return view;
}

/// Eight directions from each place, level, upwards and downwards; eyes at 1.5 m.
inline std::vector<PlaneView> look_around(const Solids& solids, const std::vector<Vec2d>& places) {
  std::vector<PlaneView> views;
  for (const Vec2d& place : places) {
    for (int k = 0; k < 8; ++k) {
      for (const double dip : {-0.45, 0.05, 0.5})
        views.push_back(look(solids, box_room::camera({place.x, -1.5, place.y}, 0.1 + 6.283185 * k / 8, dip)));
    }
  }
  return views;
}

inline std::vector<MeasuredView> measured(const std::vector<PlaneView>& views) {
  std::vector<MeasuredView> out;
  for (const PlaneView& view : views)
    out.push_back({view.camera, view.depth, ImageF(view.depth.width, view.depth.height, 1, 1.0f), {}});
  return out;
}

}  // namespace aligngs::solid_room
