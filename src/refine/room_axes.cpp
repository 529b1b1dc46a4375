#include "refine/room_axes.h"

#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

constexpr int kAxisRounds = 10;  // of small rotations; three are enough

/// A column of `axes` or its opposite: the one that a normal lies within the angle of.
std::optional<Vec3d> axis_of(const Vec3d& normal, const Mat3d& axes, double least_cosine) {
  for (int k = 0; k < 3; ++k) {
    const Vec3d axis = axes.column(k);
    const double cosine = dot(axis, normal);
    if (std::abs(cosine) >= least_cosine) return cosine > 0 ? axis : -axis;
  }
  return std::nullopt;
}

double points_along(const std::vector<ScenePlane>& planes, const Mat3d& axes, double least_cosine) {
  double points = 0;
  for (const ScenePlane& plane : planes) {
    if (axis_of(plane.normal, axes, least_cosine)) points += static_cast<double>(plane.points);
  }
  return points;
}

Mat3d with_columns(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
}

/// Right-handed, the first column as given and the second as near to `second` as can be.
Mat3d orthogonal(const Vec3d& first, const Vec3d& second) {
  const Vec3d third = normalized(cross(first, second));
  return with_columns(first, cross(third, first), third);
}

/// x with a x = b; nothing when a is singular (Cramer's rule).
std::optional<Vec3d> solve(const Mat3d& a, const Vec3d& b) {
  const double det = determinant(a);
  constexpr double kSingular = 1e-12;  // of a matrix whose numbers are at most 1
  if (std::abs(det) < kSingular) return std::nullopt;
  const Vec3d c0 = a.column(0), c1 = a.column(1), c2 = a.column(2);
  return Vec3d{dot(b, cross(c1, c2)), dot(c0, cross(b, c2)), dot(c0, cross(c1, b))} * (1 / det);
}

/// The small rotation that brings the axes nearest to the normals along them, in the least squares sense: sum of
/// w |axis + omega x axis - normal|^2.
Mat3d nearer(const Mat3d& axes, const std::vector<ScenePlane>& planes, double least_cosine) {
  Mat3d a;
  Vec3d b;
  double total = 0;
  for (const ScenePlane& plane : planes) {
    const auto axis = axis_of(plane.normal, axes, least_cosine);
    if (!axis) continue;
    const double w = static_cast<double>(plane.points);
    total += w;
    b = b + cross(*axis, plane.normal) * w;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) a(r, c) += w * ((r == c ? 1.0 : 0.0) - (*axis)[r] * (*axis)[c]);
    }
  }
  for (double& v : a.m) v /= total;
  const auto omega = solve(a, b * (1 / total));
  if (!omega) return axes;
  return orthogonal(normalized(axes.column(0) + cross(*omega, axes.column(0))),
                    axes.column(1) + cross(*omega, axes.column(1)));
}

/// Direction that floors face and ceilings face away from.
std::optional<Vec3d> up_of(const std::vector<ScenePlane>& planes, const Mat3d& axes, double least_cosine) {
  Vec3d sum;
  for (const ScenePlane& plane : planes) {
    const double sign = plane.kind == PlaneKind::kFloor ? 1 : plane.kind == PlaneKind::kCeiling ? -1 : 0;
    sum = sum + plane.normal * (sign * static_cast<double>(plane.points));
  }
  return norm(sum) > 0 ? axis_of(normalized(sum), axes, least_cosine) : std::nullopt;
}

}  // namespace

std::optional<RoomAxes> estimate_room_axes(const std::vector<ScenePlane>& planes, const RoomAxesSettings& settings) {
  const double least_cosine = std::cos(settings.angle * kRadiansPerDegree),
               right_angle = std::sin(settings.angle * kRadiansPerDegree);
  double all = 0, most = 0;
  RoomAxes best;
  for (const ScenePlane& a : planes) {
    all += static_cast<double>(a.points);
    for (const ScenePlane& b : planes) {
      if (std::abs(dot(a.normal, b.normal)) > right_angle) continue;
      const Mat3d axes = orthogonal(a.normal, b.normal);
      const double points = points_along(planes, axes, least_cosine);
      if (points <= most) continue;
      most = points;
      best.axes = axes;
    }
  }
  if (most == 0) return std::nullopt;
  for (int round = 0; round < kAxisRounds; ++round) best.axes = nearer(best.axes, planes, least_cosine);
  best.share = points_along(planes, best.axes, least_cosine) / all;
  if (best.share < settings.least_share) return std::nullopt;
  best.up = up_of(planes, best.axes, least_cosine);
  return best;
}

std::vector<ScenePlane> squared_planes(std::vector<ScenePlane> planes, const RoomAxes& axes,
                                       const RoomAxesSettings& settings) {
  const double least_cosine = std::cos(settings.angle * kRadiansPerDegree);
  for (ScenePlane& plane : planes) {
    const auto axis = axis_of(plane.normal, axes.axes, least_cosine);
    if (!axis) continue;
    plane.normal = *axis;
    plane.offset = -dot(*axis, plane.centre);
  }
  return planes;
}

}  // namespace aligngs
