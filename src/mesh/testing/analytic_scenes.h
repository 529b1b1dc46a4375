// Exact depth maps of a ball and of an empty room, for the tests of fusion.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mesh/fusion.h"
#include "mesh/fusion_frame.h"

namespace aligngs::test {

/// A camera at `eye` that looks at `target`, with `down` (image y) as near to `down` as possible.
inline Camera look_at(const Vec3d& eye, const Vec3d& target, int width, int height, double focal,
                      const Vec3d& down = {0, 1, 0}) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  const Vec3d z = normalized(target - eye), x = normalized(cross(down, z)), y = cross(z, x);
  camera.world_to_camera.rotation = {{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}};
  camera.world_to_camera.translation = -(camera.world_to_camera.rotation * eye);
  return camera;
}

/// Fills depth with t of hit(origin, direction), where direction has camera z = 1; 0 where t is not finite.
template <class Hit>
FusionFrame render(const Camera& camera, const Hit& hit) {
  FusionFrame frame;
  frame.camera = camera;
  frame.depth = ImageF(camera.width, camera.height, 1);
  const Vec3d eye = camera.centre();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vec3d direction = transpose_times(camera.world_to_camera.rotation, camera.ray(x + 0.5, y + 0.5));
      const double t = hit(eye, direction);
      if (std::isfinite(t)) frame.depth.at(x, y) = static_cast<float>(t);
    }
  }
  return frame;
}

/// Distance to a ball around the origin, seen from outside.
inline auto ball(double radius) {
  return [radius](const Vec3d& o, const Vec3d& d) {
    const double a = dot(d, d), b = dot(o, d), c = dot(o, o) - radius * radius, q = b * b - a * c;
    return q >= 0 ? (-b - std::sqrt(q)) / a : std::numeric_limits<double>::infinity();
  };
}

/// Distance to the walls of the box |x| <= half.x, ..., seen from inside.
inline auto room(const Vec3d& half) {
  return [half](const Vec3d& o, const Vec3d& d) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
      if (d[a] != 0) nearest = std::min(nearest, ((d[a] > 0 ? half[a] : -half[a]) - o[a]) / d[a]);
    }
    return nearest;
  };
}

/// Fourteen views of the ball, along the axes and the diagonals, from three radii away.
inline std::vector<FusionFrame> ball_views(double radius, int size = 160) {
  std::vector<FusionFrame> frames;
  for (int i = 0; i < 27; ++i) {
    const Vec3d towards{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
    const double length2 = dot(towards, towards);
    if (length2 != 1 && length2 != 3) continue;
    const Vec3d down = towards.x == 0 && towards.z == 0 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d eye = normalized(towards) * (3 * radius);
    frames.push_back(render(look_at(eye, {}, size, size, size * 1.2, down), ball(radius)));
  }
  return frames;
}

/// `count` views on a circle in the room, looking outwards and a little up or down in turn.
inline std::vector<FusionFrame> room_views(const Vec3d& half, int count, int width = 160, int height = 120) {
  std::vector<FusionFrame> frames;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * 3.14159265358979 * i / count, up = 0.5 * ((i % 3) - 1);
    const Vec3d eye{0.4 * half.x * std::cos(angle), 0.1 * half.y, 0.4 * half.z * std::sin(angle)};
    const Vec3d away{-std::cos(angle + 0.3), up, -std::sin(angle + 0.3)};
    frames.push_back(render(look_at(eye, eye + away, width, height, 0.7 * width), room(half)));
  }
  return frames;
}

/// Options with which a clean scene loses nothing.
inline FusionOptions fusion_options() {
  FusionOptions options;
  options.min_alpha = 0.9;
  options.min_cosine = 0.17;
  options.single_view_weight = 0.25;
  options.consistency.depth_tolerance = 0.01;
  return options;
}

}  // namespace aligngs::test
