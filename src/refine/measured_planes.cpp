#include "refine/measured_planes.h"

#include <cmath>
#include <optional>

#include "core/angles.h"
#include "core/is_depth.h"
#include "scene/depth_normals.h"

namespace aligngs {
namespace {

constexpr uint64_t kSeedOfPlanes = 1;  // the same planes every time
constexpr int kPointNormalRadius = 4;  // pixels: only a rough direction is needed

std::vector<PlanePoint> points_of(const MeasuredView& view, int index, int stride) {
  std::vector<PlanePoint> points;
  if (view.depth.empty()) return points;
  DepthNormalOptions options;
  options.radius = kPointNormalRadius;
  const ImageF normals = camera_normals(view.depth, view.camera, options);
  const Rigidd to_world = view.camera.world_to_camera.inverse();
  for (int y = stride / 2; y < view.depth.height; y += stride) {
    for (int x = stride / 2; x < view.depth.width; x += stride) {
      const Vec3d normal{normals.at(x, y, 0), normals.at(x, y, 1), normals.at(x, y, 2)};
      if (!is_depth(view.depth.at(x, y)) || dot(normal, normal) == 0) continue;
      PlanePoint point;
      point.depth = view.depth.at(x, y);
      point.position = to_world * (view.camera.ray(x + 0.5, y + 0.5) * point.depth);
      point.normal = to_world.rotation * normal;
      point.certainty = view.certainty.at(x, y);
      point.view = index;
      point.kind = PlaneKind::kWall;  // one kind for all
      points.push_back(point);
    }
  }
  return points;
}

/// A column of the axes or its opposite: the one within an angle of a direction.
std::optional<Vec3d> axis_near(const Vec3d& direction, const RoomAxes& axes, double degrees) {
  for (int k = 0; k < 3; ++k) {
    const Vec3d axis = axes.axes.column(k);
    const double cosine = dot(axis, direction);
    if (std::abs(cosine) >= std::cos(degrees * kRadiansPerDegree)) return cosine > 0 ? axis : -axis;
  }
  return std::nullopt;
}

std::vector<ScenePlane> planes_along(const RoomAxes& axes, const std::vector<PlanePoint>& points,
                                     const MeasuredPlaneSettings& settings) {
  std::vector<PlanePoint> along;
  for (const PlanePoint& point : points) {
    const auto axis = axis_near(point.normal, axes, settings.anything.normal_angle);
    if (!axis) continue;
    along.push_back(point);
    along.back().normal = *axis;
  }
  std::vector<ScenePlane> planes = find_planes(along, settings.along_axes, kSeedOfPlanes);
  std::erase_if(planes, [&](const ScenePlane& plane) { return !axis_near(plane.normal, axes, settings.axes.angle); });
  return planes;
}

}  // namespace

std::vector<ScenePlane> measured_planes(const std::vector<MeasuredView>& views, const MeasuredPlaneSettings& settings,
                                        ThreadPool& pool) {
  std::vector<std::vector<PlanePoint>> per_view(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) per_view[i] = points_of(views[i], static_cast<int>(i), settings.stride);
  });
  std::vector<PlanePoint> points;
  for (const auto& some : per_view) points.insert(points.end(), some.begin(), some.end());
  std::vector<ScenePlane> planes = find_planes(points, settings.anything, kSeedOfPlanes);
  const auto axes = settings.known_axes ? settings.known_axes : estimate_room_axes(planes, settings.axes);
  if (axes) planes = planes_along(*axes, points, settings);
  if (planes.size() > settings.most) planes.resize(settings.most);
  return planes;
}

}  // namespace aligngs
