#include "room/vertical.h"

#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

/// The normal or its opposite that is within an angle of a direction; the zero vector where neither is.
Vec3d towards(const Vec3d& direction, const Vec3d& normal, double degrees) {
  const double cosine = dot(direction, normal);
  if (!(std::abs(cosine) >= std::cos(degrees * kRadiansPerDegree))) return {};
  return cosine > 0 ? normal : -normal;
}

/// Points of the planes that are level or upright where `vertical` is up.
double points_at_right_angles(const Vec3d& vertical, const std::vector<ScenePlane>& planes, double degrees) {
  const double level = std::cos(degrees * kRadiansPerDegree), upright = std::sin(degrees * kRadiansPerDegree);
  double points = 0;
  for (const ScenePlane& plane : planes) {
    const double rise = std::abs(dot(vertical, plane.normal));
    if (rise >= level || rise <= upright) points += static_cast<double>(plane.points);
  }
  return points;
}

}  // namespace

Vec3d vertical_near(const Vec3d& up, const std::vector<ScenePlane>& planes, const VerticalSettings& s) {
  Vec3d best;
  double most = 0;
  for (const ScenePlane& plane : planes) {
    const Vec3d candidate = towards(up, plane.normal, s.search);
    if (!(norm(candidate) > 0)) continue;
    const double points = points_at_right_angles(candidate, planes, s.agreement);
    if (points > most) most = points, best = candidate;
  }
  if (most == 0) return up;
  Vec3d sum;
  for (const ScenePlane& plane : planes) {
    const Vec3d normal = towards(best, plane.normal, s.agreement);
    if (norm(normal) > 0) sum += normal * static_cast<double>(plane.points);
  }
  return normalized(sum);
}

}  // namespace aligngs
