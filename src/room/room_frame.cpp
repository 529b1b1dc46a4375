#include "room/room_frame.h"

#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

bool finite(const ScenePlane& p) {
  return std::isfinite(p.offset) && std::isfinite(dot(p.normal, p.normal)) && std::abs(norm(p.normal) - 1) < 1e-3;
}

/// The plane of a kind with most points whose normal is within the angle of `direction`; of any direction where that is
/// not known.
std::optional<size_t> largest(const std::vector<ScenePlane>& planes, PlaneKind kind,
                              const std::optional<Vec3d>& direction, double least_cosine) {
  std::optional<size_t> best;
  for (size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].kind != kind || !finite(planes[i])) continue;
    if (direction && dot(planes[i].normal, *direction) < least_cosine) continue;
    if (!best || planes[i].points > planes[*best].points) best = i;
  }
  return best;
}

}  // namespace

ScenePlane in_frame(const ScenePlane& plane, const Rigidd& to_room) {
  ScenePlane out = plane;
  out.normal = to_room.rotation * plane.normal;
  out.centre = to_room * plane.centre;
  out.offset = plane.offset - dot(out.normal, to_room.translation);
  return out;
}

Mat3d upright_rotation(const Vec3d& up, const std::optional<Vec3d>& wall_normal) {
  const Vec3d any = std::abs(up.x) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d x = normalized(wall_normal ? cross(*wall_normal, up) : cross(up, any)), y = cross(up, x);
  return {{x.x, x.y, x.z, y.x, y.y, y.z, up.x, up.y, up.z}};
}

std::optional<RoomFrame> find_room_frame(const std::vector<ScenePlane>& planes, const std::optional<Vec3d>& up,
                                         const RoomFrameSettings& s) {
  const double level = std::cos(s.level_angle * kRadiansPerDegree),
               upright = std::sin(s.upright_angle * kRadiansPerDegree);
  RoomFrame frame;
  std::optional<Vec3d> vertical =
      up && norm(*up) > 0 && std::isfinite(norm(*up)) ? std::optional(normalized(*up)) : std::nullopt;
  frame.floor = largest(planes, PlaneKind::kFloor, vertical, level);
  const auto ceiling = largest(planes, PlaneKind::kCeiling, vertical ? std::optional(-*vertical) : std::nullopt, level);
  if (frame.floor)
    vertical = planes[*frame.floor].normal;
  else if (ceiling)
    vertical = -planes[*ceiling].normal;
  if (!vertical) return std::nullopt;

  const ScenePlane* widest = nullptr;
  for (size_t i = 0; i < planes.size(); ++i) {
    if (!finite(planes[i])) continue;
    const double rise = dot(planes[i].normal, *vertical);
    // A sloping ceiling is one of any slope that faces down.
    if (planes[i].kind == PlaneKind::kCeiling && rise < -upright) frame.ceilings.push_back(i);
    if (planes[i].kind != PlaneKind::kWall || std::abs(rise) > upright) continue;
    frame.walls.push_back(i);
    if (!widest || planes[i].points > widest->points) widest = &planes[i];
  }
  // x runs along the wall with most points; without walls, along any level direction.
  frame.to_room.rotation = upright_rotation(*vertical, widest ? std::optional<Vec3d>(widest->normal) : std::nullopt);
  if (frame.floor) frame.to_room.translation = {0, 0, planes[*frame.floor].offset};
  return frame;
}

}  // namespace aligngs
