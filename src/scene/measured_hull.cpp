#include "scene/measured_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/is_depth.h"

namespace aligngs {
namespace {

/// Directions spread evenly over the sphere, by the golden angle.
std::vector<Vec3d> even_directions(int count) {
  constexpr double kGolden = 2.39996322972865332;
  std::vector<Vec3d> out;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z);
    out.push_back({r * std::cos(kGolden * i), r * std::sin(kGolden * i), z});
  }
  return out;
}

std::vector<Vec3d> measured_points(const std::vector<Camera>& cameras, const std::vector<const ImageF*>& depths,
                                   int stride) {
  std::vector<Vec3d> points;
  for (size_t i = 0; i < cameras.size(); ++i) {
    for (int y = stride / 2; y < depths[i]->height; y += stride) {
      for (int x = stride / 2; x < depths[i]->width; x += stride) {
        const float z = depths[i]->at(x, y);
        if (is_depth(z)) points.push_back(cameras[i].unproject(x + 0.5, y + 0.5, static_cast<double>(z)));
      }
    }
  }
  return points;
}

}  // namespace

MeasuredHull::MeasuredHull(const std::vector<Camera>& cameras, const std::vector<const ImageF*>& depths,
                           const MeasuredHullSettings& settings) {
  const std::vector<Vec3d> points = measured_points(cameras, depths, settings.stride);
  if (points.size() < settings.least_points) return;
  normals_ = even_directions(settings.directions);
  const auto rank = static_cast<std::ptrdiff_t>(settings.enclosed * static_cast<double>(points.size() - 1));
  std::vector<double> along(points.size());
  for (const Vec3d& n : normals_) {
    std::transform(points.begin(), points.end(), along.begin(), [&](const Vec3d& p) { return dot(n, p); });
    std::nth_element(along.begin(), along.begin() + rank, along.end());
    double reach = along[static_cast<size_t>(rank)];
    for (const Camera& camera : cameras) reach = std::max(reach, dot(n, camera.centre()));  // some look from outside
    reach_.push_back(reach);
  }
}

double MeasuredHull::exit(const Vec3d& origin, const Vec3d& direction, double margin) const {
  double length = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < normals_.size(); ++i) {
    const double left = reach_[i] + margin - dot(normals_[i], origin), speed = dot(normals_[i], direction);
    if (left <= 0) return 0;
    if (speed > 1e-12) length = std::min(length, left / speed);
  }
  return std::isfinite(length) ? length : 0;
}

double MeasuredHull::outside(const Vec3d& point) const {
  double most = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < normals_.size(); ++i) most = std::max(most, dot(normals_[i], point) - reach_[i]);
  return most;
}

}  // namespace aligngs
