// robust_extent of scene.h.
#include <algorithm>
#include <cmath>

#include "scene/scene.h"

namespace aligngs {
namespace {

constexpr double kLowQuantile = 0.05, kHighQuantile = 0.95;

/// Linear interpolation between order statistics.
double quantile(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const size_t below = static_cast<size_t>(position), above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

double robust_extent(const Scene& scene) {
  std::vector<Vec3d> points;
  for (const Vec3f& p : scene.cloud.positions) points.push_back(p.cast<double>());
  for (int view : scene.train) points.push_back(scene.views[view].camera.centre());
  double squared = 0;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    for (size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    std::sort(values.begin(), values.end());
    const double side = quantile(values, kHighQuantile) - quantile(values, kLowQuantile);
    squared += side * side;
  }
  const double extent = std::sqrt(squared) / 2;
  return extent > 0 ? extent : 1.0;  // one camera and no points: any unit is as good as another
}

}  // namespace aligngs
