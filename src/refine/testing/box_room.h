// A box of a room with a chest on its floor and a doorway, drawn in closed form. It gives what photos show and do not
// show.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rigid.h"
#include "refine/unseen_layout.h"

namespace aligngs::box_room {

// x right, y down, z forward; scene units.
inline constexpr double kSide = 2, kFloor = 1.2, kCeiling = -1.2, kEnd = 2.5;
inline constexpr uint16_t kWallLabel = 0, kFloorLabel = 1, kCeilingLabel = 2, kChestLabel = 3;
inline const std::vector<PlaneClass> kClasses = {
    {PlaneKind::kWall, false}, {PlaneKind::kFloor, false}, {PlaneKind::kCeiling, false}, {}};
inline const Vec3f kColors[] = {{0.8f, 0.8f, 0.7f}, {0.6f, 0.4f, 0.2f}, {0.95f, 0.95f, 0.95f}, {0.1f, 0.2f, 0.5f}};
/// The chest, and the doorway in the wall x = kSide, which opens on a wall 2 behind it.
inline const Vec3d kChestLow{-0.9, 0.6, 0.6}, kChestHigh{-0.1, kFloor, 1.2};
inline constexpr double kDoorNear = 0.6, kDoorFar = 1.4, kDoorTop = -0.5, kBehindDoor = 4;

struct Hit {
  double t = 0;
  uint16_t label = kWallLabel;
};

inline bool in_doorway(double y, double z) { return z > kDoorNear && z < kDoorFar && y > kDoorTop; }

/// End of a ray from inside the room.
inline Hit trace(const Vec3d& origin, const Vec3d& ray) {
  const double side = ((ray.x > 0 ? kSide : -kSide) - origin.x) / ray.x,
               end = ((ray.z > 0 ? kEnd : -kEnd) - origin.z) / ray.z;
  const double height = ((ray.y > 0 ? kFloor : kCeiling) - origin.y) / ray.y;
  Hit hit{std::min({side, end, height}), kWallLabel};
  if (hit.t == height) hit.label = ray.y > 0 ? kFloorLabel : kCeilingLabel;
  const Vec3d at = origin + ray * hit.t;
  if (hit.t == side && ray.x > 0 && in_doorway(at.y, at.z)) hit.t = std::min((kBehindDoor - origin.x) / ray.x, height);
  double enter = 0, leave = 1e30;
  for (int k = 0; k < 3; ++k) {
    const double a = (kChestLow[k] - origin[k]) / ray[k], b = (kChestHigh[k] - origin[k]) / ray[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > 0 && enter < leave && enter < hit.t) hit = {enter, kChestLabel};
  return hit;
}

/// A camera at `centre` that looks along +z, turned to the right by `turn` radians and down by `dip`.
inline Camera camera(const Vec3d& centre, double turn, double dip = 0.15) {
  Camera out;
  out.width = 160;
  out.height = 120;
  out.fx = out.fy = 110;
  out.cx = 80;
  out.cy = 60;
  const double c = std::cos(turn), s = std::sin(turn), cd = std::cos(dip), sd = std::sin(dip);
  const Mat3d yaw{{c, 0, -s, 0, 1, 0, s, 0, c}}, pitch{{1, 0, 0, 0, cd, -sd, 0, sd, cd}};
  out.world_to_camera.rotation = pitch * yaw;
  out.world_to_camera.translation = -(out.world_to_camera.rotation * centre);
  return out;
}

/// The exact photo, depth and labels of a camera in the room.
inline LayoutView look(const Camera& camera) {
  LayoutView view;
  view.plane.camera = camera;
  view.plane.depth = ImageF(camera.width, camera.height, 1);
  view.plane.certainty = ImageF(camera.width, camera.height, 1, 1.0f);
  view.plane.labels = Image<uint16_t>(camera.width, camera.height, 1);
  view.color = ImageF(camera.width, camera.height, 3);
  const Mat3d to_world = transpose(camera.world_to_camera.rotation);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Hit hit = trace(camera.centre(), to_world * camera.ray(x + 0.5, y + 0.5));
      view.plane.depth.at(x, y) = static_cast<float>(hit.t);
      view.plane.labels.at(x, y) = hit.label;
      for (int c = 0; c < 3; ++c) view.color.at(x, y, c) = kColors[hit.label][c];
    }
  }
  return view;
}

/// Six cameras near the end z = -kEnd, all looking away from it.
inline std::vector<Camera> cameras() {
  std::vector<Camera> out;
  for (int i = 0; i < 6; ++i)
    out.push_back(camera({-1.2 + 0.45 * i, -0.1 + 0.1 * (i % 3), -1.6 + 0.15 * (i % 2)}, 0.25 * i - 0.6));
  return out;
}

inline std::vector<LayoutView> photos() {
  std::vector<LayoutView> out;
  for (const Camera& c : cameras()) out.push_back(look(c));
  return out;
}

}  // namespace aligngs::box_room
