#include "scene/up_direction.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/random.h"
#include "scene/plane_fit.h"

namespace aligngs {
namespace {

constexpr double kCosTilt = 0.866;       // 30 degrees: photos of a room look down or up by less on the mean
constexpr size_t kFewestPoints = 100;    // fewer form planes by chance
constexpr size_t kMostPoints = 4000;     // of the cloud, evenly taken: a floor has hundreds of them
constexpr int kTrials = 600;             // a floor of a fifth of the points is met within them almost surely
constexpr double kThickness = 0.01;      // of the cloud's extent: noise of SfM points on a floor
constexpr double kFewestInliers = 0.05;  // of the points
constexpr double kMostBelow = 0.05;      // of the points: nothing but outliers lies below a floor

Vec3d sum_of_ups(const std::vector<ViewUp>& views) {
  Vec3d sum;
  for (const ViewUp& view : views) sum = sum + view.up;
  return sum;
}

/// Fits a plane again and again to the nearer points; those on other surfaces fall away.
PlaneFit robust_plane(std::vector<Vec3d> points, const Vec3d& towards) {
  constexpr int kRounds = 5;
  PlaneFit plane = fit_plane(points, {}, towards);
  for (int round = 0; round < kRounds && points.size() > kFewestPoints; ++round) {
    std::vector<double> distances;
    for (const Vec3d& p : points) distances.push_back(std::fabs(dot(plane.normal, p - plane.centre)));
    const double limit = 3 * median_of(distances);
    std::erase_if(points, [&](const Vec3d& p) { return std::fabs(dot(plane.normal, p - plane.centre)) > limit; });
    plane = fit_plane(points, {}, towards);
  }
  return plane;
}

double extent_of(const std::vector<Vec3d>& points) {
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3d& p : points) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    const double side = values[values.size() * 95 / 100] - values[values.size() * 5 / 100];
    squared += side * side;
  }
  return std::sqrt(squared) / 2;
}

/// The plane with most points that has the cameras above it and next to nothing below.
std::optional<Vec3d> floor_of(const std::vector<ViewUp>& views, const std::vector<Vec3d>& all, const Vec3d& mean) {
  std::vector<Vec3d> points;
  const size_t step = std::max<size_t>(1, all.size() / kMostPoints);
  for (size_t i = 0; i < all.size(); i += step) points.push_back(all[i]);
  if (points.size() < kFewestPoints) return std::nullopt;
  const double thickness = kThickness * extent_of(points);
  Random random(1);
  size_t most = static_cast<size_t>(kFewestInliers * static_cast<double>(points.size()));
  std::vector<Vec3d> best;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto pick = [&] { return points[random.below(static_cast<uint32_t>(points.size()))]; };
    const Vec3d a = pick(), b = pick(), c = pick();
    Vec3d normal = cross(b - a, c - a);
    if (!(norm(normal) > 0)) continue;
    normal = normalized(normal);
    if (dot(normal, mean) < 0) normal = -normal;
    if (dot(normal, mean) < kCosTilt) continue;
    const bool above =
        std::all_of(views.begin(), views.end(), [&](const ViewUp& view) { return dot(normal, view.centre - a) > 0; });
    if (!above) continue;
    std::vector<Vec3d> inliers;
    size_t below = 0;
    for (const Vec3d& p : points) {
      const double height = dot(normal, p - a);
      if (std::fabs(height) <= thickness) inliers.push_back(p);
      below += height < -3 * thickness;
    }
    if (inliers.size() <= most || static_cast<double>(below) > kMostBelow * static_cast<double>(points.size()))
      continue;
    most = inliers.size();
    best = std::move(inliers);
  }
  if (best.empty()) return std::nullopt;
  return fit_plane(best, {}, mean).normal;
}

}  // namespace

ViewUp view_up(const Rigidd& world_to_camera, int orientation) {
  // EXIF 2.3: which side of the stored picture is the visual top.
  constexpr int kTopIsBottom = 3, kTopIsBottomMirrored = 4;
  Vec3d up{0, -1, 0};
  if (orientation == kTopIsBottom || orientation == kTopIsBottomMirrored) up = {0, 1, 0};
  if (orientation == 5 || orientation == 6) up = {-1, 0, 0};  // its left side
  if (orientation == 7 || orientation == 8) up = {1, 0, 0};   // its right side
  const Rigidd to_world = world_to_camera.inverse();
  return {to_world.translation, to_world.rotation * up};
}

bool agrees_with(const std::vector<ViewUp>& views, const Vec3d& up, bool measured) {
  constexpr double kAgreed = 0.8;  // of the number of cameras: ups that lie within about 40 degrees of their mean
  constexpr double kCosConvention = 0.5;  // 60 degrees
  constexpr double kCosMeasured = -0.5;   // 120 degrees: upside down, and no photo that was held upright
  const Vec3d sum = sum_of_ups(views);
  if (norm(sum) < kAgreed * static_cast<double>(views.size()) || views.empty()) return dot(sum, up) >= 0 || measured;
  return dot(normalized(sum), up) >= (measured ? kCosMeasured : kCosConvention);
}

std::optional<UpDirection> estimate_up(const std::vector<ViewUp>& views, const std::vector<Vec3d>& floor,
                                       const std::vector<Vec3d>& points) {
  const Vec3d sum = sum_of_ups(views);
  constexpr double kCancelled = 0.1;  // of the number of cameras
  if (views.empty() || norm(sum) < kCancelled * static_cast<double>(views.size())) return std::nullopt;
  const Vec3d mean = normalized(sum);
  if (floor.size() >= kFewestPoints) {
    const Vec3d normal = robust_plane(floor, mean).normal;
    if (dot(normal, mean) > kCosTilt) return UpDirection{normal, "floor labels"};
  }
  if (const auto normal = floor_of(views, points, mean)) return UpDirection{*normal, "fitted floor plane"};
  return UpDirection{mean, "mean up of the cameras"};
}

}  // namespace aligngs
