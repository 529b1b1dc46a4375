#include "room/level_planes.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/quantile.h"

namespace aligngs {
namespace {

/// Points on a plane and beyond it.
struct PlaneSides {
  double on = 0, beyond = 0;
};

PlaneSides sides_of(const ScenePlane& plane, const std::vector<SeenPoint>& points, double on, double beyond) {
  constexpr double kFacing = 0.9;  // cosine
  PlaneSides out;
  for (const SeenPoint& point : points) {
    const double distance = plane.distance(point.to);
    out.on += std::abs(distance) < on && dot(plane.normal, point.normal) > kFacing;
    out.beyond += distance < -beyond;
  }
  return out;
}

struct LevelCandidate {
  size_t plane;
  PlaneSides sides;
};

/// Those with enough points on them and few beyond.
std::vector<size_t> kept(const std::vector<LevelCandidate>& candidates, const LevelPlaneSettings& s) {
  double most = 0;
  for (const LevelCandidate& c : candidates) most = std::max(most, c.sides.on);
  std::vector<size_t> out;
  for (const LevelCandidate& c : candidates) {
    if (c.sides.on > 0 && c.sides.on >= s.least_points * most && c.sides.beyond <= s.most_beyond * c.sides.on)
      out.push_back(c.plane);
  }
  return out;
}

}  // namespace

LevelPlanes find_level_planes(const std::vector<ScenePlane>& planes, const std::vector<SeenPoint>& points,
                              const LevelPlaneSettings& s) {
  std::vector<double> cameras, heights;
  for (const SeenPoint& point : points) {
    cameras.push_back(point.from.z);
    heights.push_back(point.to.z);
  }
  LevelPlanes out;
  out.low = quantile_of(heights, s.stray);
  out.high = quantile_of(heights, 1 - s.stray);
  const double unit = out.high - out.low, lowest = quantile_of(cameras, 0.1), highest = quantile_of(cameras, 0.9);
  const double level = std::cos(s.level_angle * kRadiansPerDegree),
               upright = std::sin(s.upright_angle * kRadiansPerDegree);
  std::vector<LevelCandidate> floors, level_ceilings, slopes;
  for (size_t i = 0; i < planes.size(); ++i) {
    const ScenePlane& plane = planes[i];
    const double rise = plane.normal.z, height = plane.centre.z;
    if (!std::isfinite(plane.offset) || !std::isfinite(rise)) continue;
    const bool up = rise >= level && height < lowest, down = rise <= -level && height > highest,
               slope = rise > -level && rise < -upright && height > (lowest + highest) / 2;
    if (!up && !down && !slope) continue;
    (up     ? floors
     : down ? level_ceilings
            : slopes)
        .push_back({i, sides_of(plane, points, s.on * unit, s.beyond * unit)});
  }
  const auto below = [&planes](size_t a, size_t b) { return planes[a].centre.z < planes[b].centre.z; };
  const std::vector<size_t> floor = kept(floors, s), ceiling = kept(level_ceilings, s);
  if (!floor.empty()) {
    out.floor = *std::min_element(floor.begin(), floor.end(), below);
    out.low = planes[*out.floor].centre.z;
  }
  if (!ceiling.empty()) {
    out.ceilings.push_back(*std::max_element(ceiling.begin(), ceiling.end(), below));
    out.high = planes[out.ceilings.front()].centre.z;
  }
  // A room without a ceiling is as high as the photos were taken: its walls end no lower.
  if (ceiling.empty() && !cameras.empty()) out.high = std::max(out.high, quantile_of(cameras, 1));
  const std::vector<size_t> sloping = kept(slopes, s);
  out.ceilings.insert(out.ceilings.end(), sloping.begin(), sloping.end());
  return out;
}

}  // namespace aligngs
