#include "core/far_outliers.h"

#include <algorithm>
#include <utility>

#include "core/quantile.h"

namespace aligngs {
namespace {

constexpr size_t kFewestPlaces = 4;
constexpr size_t kShareOfOutliers = 10;  // one place of this many may be one
constexpr double kTimes = 1e4;           // of the distance of the others; scenes with sky reach a thousand
constexpr double kLeastDistance = 1000;  // units: jitter around one place has outliers as well

double median_coordinate(std::span<const Vec3d> places, int axis) {
  std::vector<double> values;
  for (const Vec3d& place : places) values.push_back(place[axis]);
  return quantile_of(std::move(values), 0.5);
}

}  // namespace

std::vector<bool> far_outliers(std::span<const Vec3d> places) {
  std::vector<bool> far(places.size(), false);
  if (places.size() < kFewestPlaces) return far;
  const Vec3d centre{median_coordinate(places, 0), median_coordinate(places, 1), median_coordinate(places, 2)};
  std::vector<double> distances;
  for (const Vec3d& place : places) distances.push_back(norm(place - centre));
  std::vector<double> sorted = distances;
  const size_t outliers = std::max<size_t>(1, places.size() / kShareOfOutliers);
  const auto last = sorted.end() - static_cast<std::ptrdiff_t>(outliers) - 1;
  std::nth_element(sorted.begin(), last, sorted.end());
  if (!(*last > 0)) return far;
  for (size_t i = 0; i < far.size(); ++i) far[i] = distances[i] > kLeastDistance && distances[i] > kTimes * *last;
  return far;
}

}  // namespace aligngs
