#include "refine/panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/angles.h"
#include "core/disjoint_sets.h"
#include "core/median.h"
#include "core/random.h"
#include "scene/plane_fit.h"

namespace aligngs {
namespace {

constexpr int kPanelRefinements = 8;   // of reweighted least squares, which settles after three to five
constexpr size_t kPanelScored = 2000;  // points that candidates are compared on
constexpr double kPanelTail = 0.02;    // of the points on each side that a rectangle does not follow

using Points = std::vector<PanelPoint>;

bool usable(const PanelPoint& p) {
  return p.depth > 0 && p.certainty > 0 &&
         std::isfinite(p.position.x + p.position.y + p.position.z + p.depth + p.certainty);
}

/// Regions whose points lie in the same places are photos of one thing. A list of points per thing, in the order of the
/// regions.
std::vector<Points> things(const Points& points, const PanelSettings& s) {
  std::vector<double> depths;
  uint32_t parts = 0;
  for (const PanelPoint& p : points) {
    depths.push_back(p.depth);
    parts = std::max(parts, p.part + 1);
  }
  const double side = s.cell * median_of(std::move(depths));
  std::map<std::array<int64_t, 3>, std::map<uint32_t, int>> cells;
  for (const PanelPoint& p : points) {
    std::array<int64_t, 3> cell;
    for (int k = 0; k < 3; ++k) cell[static_cast<size_t>(k)] = static_cast<int64_t>(std::floor(p.position[k] / side));
    ++cells[cell][p.part];
  }
  DisjointSets same(parts);
  for (const auto& [cell, count_of] : cells) {
    std::optional<uint32_t> first;
    for (const auto& [part, count] : count_of) {
      if (count < s.together) continue;
      if (first) same.unite(*first, part);
      first = part;
    }
  }
  std::map<uint32_t, Points> out;
  for (const PanelPoint& p : points) out[same.find(p.part)].push_back(p);
  std::vector<Points> lists;
  for (auto& [part, list] : out) lists.push_back(std::move(list));
  return lists;
}

struct Plane {
  Vec3d normal;
  double offset = 0;
  double distance(const Vec3d& x) const { return dot(normal, x) + offset; }
};

double support(const Points& points, const Plane& plane, const PanelSettings& s) {
  double sum = 0;
  for (const PanelPoint& p : points) {
    if (std::abs(plane.distance(p.position)) < s.inlier * p.depth) sum += p.certainty;
  }
  return sum;
}

/// The most supported of planes through three points, and of planes parallel to a wall through one.
Plane best_candidate(const Points& points, const std::vector<ScenePlane>& walls, const PanelSettings& s,
                     Random& random) {
  Points scored = points;
  random.shuffle(scored);
  scored.resize(std::min(scored.size(), kPanelScored));
  const auto any = [&]() -> const Vec3d& {
    return points[static_cast<size_t>(random.below(static_cast<int>(points.size())))].position;
  };
  Plane best;
  double most = 0;
  for (int c = 0; c < s.candidates; ++c) {
    const Vec3d& a = any();
    Plane plane;
    if (c % 2 == 0 || walls.empty()) {
      const Vec3d &b = any(), &d = any();
      plane.normal = normalized(cross(b - a, d - a));
      if (norm(plane.normal) == 0) continue;
    } else {
      plane.normal = walls[static_cast<size_t>(random.below(static_cast<int>(walls.size())))].normal;
    }
    plane.offset = -dot(plane.normal, a);
    const double sum = support(scored, plane, s);
    if (sum > most) {
      most = sum;
      best = plane;
    }
  }
  return best;
}

Points inliers(const Points& points, const Plane& plane, const PanelSettings& s) {
  Points out;
  for (const PanelPoint& p : points) {
    if (std::abs(plane.distance(p.position)) < s.inlier * p.depth) out.push_back(p);
  }
  return out;
}

/// Place with half of the weight on either side.
double weighted_median(std::vector<std::pair<double, double>> value_and_weight) {
  std::sort(value_and_weight.begin(), value_and_weight.end());
  double whole = 0, sum = 0;
  for (const auto& [value, weight] : value_and_weight) whole += weight;
  for (const auto& [value, weight] : value_and_weight) {
    sum += weight;
    if (2 * sum >= whole) return value;
  }
  return 0;
}

/// Robust (Cauchy) total least squares, then parallel to the wall that is nearly so.
Plane refine(const Points& near, Plane plane, const std::vector<ScenePlane>& walls, const PanelSettings& s) {
  std::vector<Vec3d> positions;
  for (const PanelPoint& p : near) positions.push_back(p.position);
  std::vector<double> weights(near.size());
  for (int round = 0; round < kPanelRefinements; ++round) {
    for (size_t k = 0; k < near.size(); ++k) {
      const double residual = plane.distance(positions[k]) / (0.5 * s.inlier * near[k].depth);
      weights[k] = near[k].certainty / (near[k].depth * near[k].depth) / (1 + residual * residual);
    }
    const PlaneFit fit = fit_plane(positions, weights, plane.normal);
    plane = {fit.normal, -dot(fit.normal, fit.centre)};
  }
  double closest = std::cos(s.snap_angle * kRadiansPerDegree);
  std::optional<Vec3d> parallel;
  for (const ScenePlane& wall : walls) {
    const double cosine = dot(wall.normal, plane.normal);
    if (std::abs(cosine) < closest) continue;
    closest = std::abs(cosine);
    parallel = cosine > 0 ? wall.normal : -wall.normal;
  }
  if (!parallel) return plane;
  std::vector<std::pair<double, double>> offsets;
  for (size_t k = 0; k < near.size(); ++k) offsets.emplace_back(-dot(*parallel, positions[k]), weights[k]);
  return {*parallel, weighted_median(std::move(offsets))};
}

bool is_level(const ScenePlane& p) { return p.kind == PlaneKind::kFloor || p.kind == PlaneKind::kCeiling; }

/// Standard deviation.
double spread(const std::vector<double>& values) {
  double mean = 0, square = 0;
  for (const double x : values) mean += x / static_cast<double>(values.size());
  for (const double x : values) square += (x - mean) * (x - mean) / static_cast<double>(values.size());
  return std::sqrt(square);
}

/// The rectangle of the points of a plane; nothing where they lie in a line, are of too few photos, or the plane is
/// level.
std::optional<Panel> panel_on(const Plane& plane, const Points& near, const std::vector<ScenePlane>& planes,
                              const PanelSettings& s) {
  double facing = 0;
  std::set<int> views;
  std::vector<double> depths;
  for (const PanelPoint& p : near) {
    views.insert(p.view);
    depths.push_back(p.depth);
    facing += plane.distance(p.camera) > 0 ? p.certainty : -p.certainty;
  }
  const bool level = std::any_of(planes.begin(), planes.end(), [&](const ScenePlane& p) {
    return is_level(p) && std::abs(dot(p.normal, plane.normal)) > s.level_cosine;
  });
  if (level || static_cast<int>(views.size()) < s.least_views) return std::nullopt;
  Panel panel;
  panel.normal = facing >= 0 ? plane.normal : -plane.normal;
  panel.offset = facing >= 0 ? plane.offset : -plane.offset;
  panel.views = static_cast<int>(views.size());
  panel.points = near.size();
  set_upright(panel, planes);
  const double depth = panel.depth = median_of(std::move(depths));
  for (int k = 0; k < 2; ++k) {
    std::vector<double> along;
    for (const PanelPoint& p : near) along.push_back(dot(k == 0 ? panel.across : panel.up, p.position));
    std::sort(along.begin(), along.end());
    if (spread(along) < s.least_spread * depth) return std::nullopt;
    const size_t tail = static_cast<size_t>(kPanelTail * static_cast<double>(along.size()));
    panel.low[k] = along[tail] - s.rim * depth;
    panel.high[k] = along[along.size() - 1 - tail] + s.rim * depth;
  }
  return panel;
}

/// The panels of one thing, the best supported first.
void add_panels_of(Points points, const std::vector<ScenePlane>& planes, const std::vector<ScenePlane>& walls,
                   const PanelSettings& s, Random random, std::vector<Panel>& panels) {
  double whole = 0;
  for (const PanelPoint& p : points) whole += p.certainty;
  for (int n = 0; n < s.most_of_thing && points.size() >= s.least_points; ++n) {
    Plane plane = best_candidate(points, walls, s, random);
    for (int round = 0; round < 2; ++round) {
      const Points near = inliers(points, plane, s);
      if (near.size() < s.least_points) return;
      plane = refine(near, plane, walls, s);
    }
    const Points near = inliers(points, plane, s);
    if (near.size() < s.least_points || support(near, plane, s) < s.least_share * whole) return;
    if (const std::optional<Panel> panel = panel_on(plane, near, planes, s)) panels.push_back(*panel);
    // Points a little farther off are the same surface, measured worse.
    std::erase_if(points,
                  [&](const PanelPoint& p) { return std::abs(plane.distance(p.position)) < 2 * s.inlier * p.depth; });
  }
}

}  // namespace

std::optional<Vec3d> vertical_of(const std::vector<ScenePlane>& planes) {
  for (const ScenePlane& plane : planes) {
    if (plane.kind == PlaneKind::kFloor) return plane.normal;
  }
  for (const ScenePlane& plane : planes) {
    if (plane.kind == PlaneKind::kCeiling) return -plane.normal;
  }
  return std::nullopt;
}

void set_upright(Panel& panel, const std::vector<ScenePlane>& planes) {
  Vec3d vertical = vertical_of(planes).value_or(Vec3d{});
  for (int k = 0; norm(vertical) == 0 && k < 3; ++k) {
    Vec3d axis{};
    axis[k] = 1;
    if (std::abs(dot(axis, panel.normal)) < 0.7) vertical = axis;  // of three axes, at least two are
  }
  panel.across = normalized(cross(vertical, panel.normal));
  panel.up = cross(panel.normal, panel.across);
}

std::vector<Panel> find_panels(const std::vector<PanelPoint>& points, const std::vector<ScenePlane>& planes,
                               const PanelSettings& settings, uint64_t seed) {
  Points known;
  std::copy_if(points.begin(), points.end(), std::back_inserter(known), [](const PanelPoint& p) { return usable(p); });
  if (known.empty()) return {};
  std::vector<ScenePlane> walls;
  std::copy_if(planes.begin(), planes.end(), std::back_inserter(walls),
               [](const ScenePlane& p) { return p.kind == PlaneKind::kWall; });
  std::vector<Panel> panels;
  const std::vector<Points> lists = things(known, settings);
  for (size_t i = 0; i < lists.size(); ++i)
    add_panels_of(lists[i], planes, walls, settings, Random(seed).fork(i), panels);
  return panels;
}

}  // namespace aligngs
