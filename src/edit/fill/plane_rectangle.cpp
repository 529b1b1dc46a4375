#include "edit/fill/plane_rectangle.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr double kRectangleStrays = 0.02;  ///< share of the places on each side
constexpr int kTurns = 90;                 ///< directions that are tried, one per degree

Vec2d in_frame(const Vec2d& p, const Vec2d& centre, const Vec2d& along) {
  const double x = p.x - centre.x, y = p.y - centre.y;
  return {along.x * x + along.y * y, -along.y * x + along.x * y};
}

/// Smallest and largest value without the strays.
void bounds(std::vector<double>& values, double& low, double& high) {
  const size_t cut = static_cast<size_t>(kRectangleStrays * static_cast<double>(values.size()));
  const auto at = [&](size_t k) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(k), values.end());
    return values[k];
  };
  low = at(cut);
  high = at(values.size() - 1 - cut);
}

}  // namespace

bool PlaneRectangle::holds(const Vec2d& place, double margin) const {
  const Vec2d p = in_frame(place, centre, along);
  return p.x >= low[0] - margin && p.x <= high[0] + margin && p.y >= low[1] - margin && p.y <= high[1] + margin;
}

PlaneRectangle rectangle_of(const std::vector<Vec2d>& places) {
  PlaneRectangle best;
  Vec2d centre;
  for (const Vec2d& p : places) {
    centre.x += p.x / static_cast<double>(places.size());
    centre.y += p.y / static_cast<double>(places.size());
  }
  double least = 1e300;
  std::vector<double> x(places.size()), y(places.size());
  for (int turn = 0; turn < kTurns; ++turn) {
    const double angle = turn * 3.14159265358979 / 180;
    PlaneRectangle r;
    r.centre = centre;
    r.along = {std::cos(angle), std::sin(angle)};
    for (size_t i = 0; i < places.size(); ++i) {
      const Vec2d p = in_frame(places[i], centre, r.along);
      x[i] = p.x;
      y[i] = p.y;
    }
    bounds(x, r.low[0], r.high[0]);
    bounds(y, r.low[1], r.high[1]);
    const double area = (r.high[0] - r.low[0]) * (r.high[1] - r.low[1]);
    if (area < least) {
      least = area;
      best = r;
    }
  }
  return best;
}

}  // namespace aligngs
