#include "edit/fill/room_planes.h"

#include <algorithm>
#include <cmath>

#include "core/quaternion.h"
#include "gaussians/gaussian_geometry.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr uint64_t kSeed = 1;

PlaneSettings plane_settings(const RoomPlaneSettings& settings) {
  PlaneSettings out;
  // of the distance to the place inside: 5 cm at 2.5 m; a trained wall is less bent than a network's
  out.inlier = 0.02;
  out.merge_distance = 0.03;
  out.least_views = 1;  // Gaussians are of no view
  out.least_points = settings.least_carriers;
  return out;
}

}  // namespace

Vec3d place_inside(const LabelledGaussians& room, const std::vector<Camera>& cameras) {
  Vec3d sum;
  if (!cameras.empty()) {
    for (const Camera& c : cameras) sum += c.centre() * (1.0 / static_cast<double>(cameras.size()));
    return sum;
  }
  for (size_t i = 0; i < room.model.size(); ++i)
    sum += position_of(room.model, i) * (1.0 / static_cast<double>(room.model.size()));
  return sum;
}

std::vector<RoomPlane> room_planes(const LabelledGaussians& room, const std::vector<CarryingClass>& classes,
                                   const std::vector<uint8_t>& left_out, const Vec3d& inside,
                                   const RoomPlaneSettings& settings) {
  std::vector<PlanePoint> points;
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < room.model.size(); ++i) {
    const uint16_t label = room.labels.label[i];
    if (left_out[i] || label == kNoLabel || label >= classes.size() || opacity_of(room.model, i) < settings.solid)
      continue;
    PlanePoint point;
    point.kind = classes[label].shell;
    if (point.kind == PlaneKind::kNone) continue;
    point.position = position_of(room.model, i);
    const Vec3d to_inside = inside - point.position;
    point.depth = norm(to_inside);
    point.normal = shortest_axis(room.model, i);
    if (dot(point.normal, to_inside) < 0) point.normal = -point.normal;
    points.push_back(point);
    rows.push_back(i);
  }
  std::vector<RoomPlane> out;
  for (const ScenePlane& found : find_planes(points, plane_settings(settings), kSeed)) {
    RoomPlane plane;
    plane.kind = found.kind;
    plane.normal = found.normal;
    plane.offset = -found.offset;
    if (dot(plane.normal, inside) < plane.offset) {
      plane.normal = -plane.normal;
      plane.offset = -plane.offset;
    }
    plane.low = {1e300, 1e300, 1e300};
    plane.high = {-1e300, -1e300, -1e300};
    for (size_t k = 0; k < points.size(); ++k) {
      if (points[k].kind != plane.kind ||
          std::fabs(plane.height(points[k].position)) > settings.tolerance * room.extent ||
          std::fabs(dot(plane.normal, points[k].normal)) < settings.facing) {
        continue;
      }
      plane.carriers.push_back(rows[k]);
      for (int a = 0; a < 3; ++a) {
        plane.low[a] = std::min(plane.low[a], points[k].position[a]);
        plane.high[a] = std::max(plane.high[a], points[k].position[a]);
      }
    }
    if (plane.carriers.size() >= settings.least_carriers) out.push_back(std::move(plane));
  }
  return out;
}

bool has_surface_at(const RoomPlane& plane, const Vec3d& place, double reach) {
  const Vec3d foot = place - plane.normal * plane.height(place);
  for (int a = 0; a < 3; ++a) {
    if (!(foot[a] > plane.low[a] - reach && foot[a] < plane.high[a] + reach)) return false;
  }
  return true;
}

bool is_inside(const Vec3d& place, const std::vector<RoomPlane>& planes, double tolerance, double reach) {
  for (const RoomPlane& plane : planes) {
    if (plane.height(place) <= -tolerance && has_surface_at(plane, place, reach)) return false;
  }
  return true;
}

}  // namespace aligngs
