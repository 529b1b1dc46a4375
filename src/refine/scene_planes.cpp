#include "refine/scene_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/angles.h"
#include "core/median.h"
#include "core/random.h"
#include "scene/plane_fit.h"

namespace aligngs {
namespace {

constexpr int kRefinements = 12;  // of reweighted least squares; it settles after six to ten
constexpr size_t kScored = 4000;  // points that candidates are compared on: more do not change which one wins
constexpr std::array<PlaneKind, 4> kKinds = {PlaneKind::kFloor, PlaneKind::kCeiling, PlaneKind::kWall,
                                             PlaneKind::kTable};

using Indices = std::vector<size_t>;

bool belongs(const PlanePoint& p, const ScenePlane& plane, double tolerance, double least_cosine) {
  return std::abs(plane.distance(p.position)) < tolerance * p.depth && dot(plane.normal, p.normal) > least_cosine;
}

Indices members(const std::vector<PlanePoint>& points, const Indices& of, const ScenePlane& plane,
                const PlaneSettings& s, double tolerance_factor = 1) {
  const double least_cosine = std::cos(s.normal_angle * kRadiansPerDegree);
  Indices out;
  for (const size_t i : of) {
    if (belongs(points[i], plane, tolerance_factor * s.inlier, least_cosine)) out.push_back(i);
  }
  return out;
}

/// Weights of points in a fit: what a photo's network depth says of a plane counts as few samples, however many pixels.
std::vector<double> fit_weights(const std::vector<PlanePoint>& points, const Indices& of, const PlaneSettings& s) {
  std::map<int, double> per_view;
  for (const size_t i : of) per_view[points[i].view] += 1;
  std::vector<double> out;
  for (const size_t i : of) {
    const PlanePoint& p = points[i];
    const double prior = std::min(1.0, s.prior_independent / per_view[p.view]) / (s.prior_sigma * s.prior_sigma);
    const double measured = p.certainty / s.measured_together / (s.measured_sigma * s.measured_sigma);
    out.push_back((prior + measured) / (p.depth * p.depth));
  }
  return out;
}

/// Mean distance of the proud points from the plane, given `weights` (inverse variances) and what is expected of such
/// things.
double mean_proud(const std::vector<PlanePoint>& points, const Indices& near, const std::vector<double>& weights,
                  const ScenePlane& plane, const PlaneSettings& s) {
  double sum = 0, total = 0, depth = 0, count = 0;
  for (size_t k = 0; k < near.size(); ++k) {
    const PlanePoint& p = points[near[k]];
    if (!p.proud) continue;
    sum += weights[k] * plane.distance(p.position);
    total += weights[k];
    depth += p.depth;
    ++count;
  }
  if (count == 0) return 0;
  const double expected = s.proud_mean * depth / count, sigma = s.proud_sigma * depth / count;
  return (sum + expected / (sigma * sigma)) / (total + 1 / (sigma * sigma));
}

/// Robust (Cauchy) total least squares from a first guess, with the points that are near it. Proud points count for the
/// plane behind them. The plane was found with the normal `found`.
ScenePlane refine(const std::vector<PlanePoint>& points, const Indices& near, ScenePlane plane, const Vec3d& found,
                  const PlaneSettings& s) {
  const double hold = s.turn_sigma > 0 ? std::pow(s.turn_sigma * kRadiansPerDegree, -2) : 0;
  const std::vector<double> base = fit_weights(points, near, s);
  std::vector<Vec3d> positions;
  std::vector<double> weights(near.size());
  for (int round = 0; round < kRefinements && !near.empty(); ++round) {
    positions.clear();
    for (const size_t i : near)
      positions.push_back(points[i].position - plane.normal * (points[i].proud ? plane.proud : 0));
    for (size_t k = 0; k < near.size(); ++k) {
      const double residual = plane.distance(positions[k]) / (s.prior_sigma * points[near[k]].depth);
      weights[k] = base[k] / (1 + residual * residual);
    }
    const PlaneFit fit = fit_plane(positions, weights, hold > 0 ? found : plane.normal, hold);
    plane.normal = fit.normal;
    plane.centre = fit.centre;
    plane.offset = -dot(fit.normal, fit.centre);
    plane.proud = mean_proud(points, near, weights, plane, s);
  }
  return plane;
}

/// Points near a plane; where they cannot be more than `most`, any number up to that.
size_t count_members(const std::vector<PlanePoint>& points, const ScenePlane& plane, const PlaneSettings& s,
                     double least_cosine, size_t most) {
  size_t count = 0;
  for (size_t k = 0; k < points.size() && count + (points.size() - k) > most; ++k)
    count += belongs(points[k], plane, s.inlier, least_cosine);
  return count;
}

ScenePlane best_candidate(const std::vector<PlanePoint>& points, const Indices& of, const PlaneSettings& s,
                          Random& random) {
  Indices scored = of;
  random.shuffle(scored);
  scored.resize(std::min(scored.size(), kScored));
  std::vector<PlanePoint> compared;
  compared.reserve(scored.size());
  for (const size_t i : scored) compared.push_back(points[i]);
  const double least_cosine = std::cos(s.normal_angle * kRadiansPerDegree);
  ScenePlane best;
  size_t most = 0;
  for (int c = 0; c < s.candidates; ++c) {
    const PlanePoint& p = points[of[static_cast<size_t>(random.below(static_cast<int>(of.size())))]];
    ScenePlane plane;
    plane.normal = p.normal;
    plane.offset = -dot(p.normal, p.position);
    plane.kind = p.kind;
    const size_t count = count_members(compared, plane, s, least_cosine, most);
    if (count > most) {
      most = count;
      best = plane;
    }
  }
  return best;
}

Indices without(const Indices& all, const Indices& taken) {
  Indices out;
  std::set_difference(all.begin(), all.end(), taken.begin(), taken.end(), std::back_inserter(out));
  return out;
}

int views_of(const std::vector<PlanePoint>& points, const Indices& of) {
  std::set<int> views;
  for (const size_t i : of) views.insert(points[i].view);
  return static_cast<int>(views.size());
}

bool same_plane(const ScenePlane& a, const ScenePlane& b, const std::vector<PlanePoint>& points, const Indices& of_b,
                const PlaneSettings& s) {
  if (dot(a.normal, b.normal) < std::cos(s.merge_angle * kRadiansPerDegree)) return false;
  std::vector<double> apart;
  for (const size_t i : of_b) apart.push_back(std::abs(a.distance(points[i].position)) / points[i].depth);
  return median_of(std::move(apart)) < s.merge_distance;
}

void find_planes_of(PlaneKind kind, const std::vector<PlanePoint>& points, const PlaneSettings& s, Random random,
                    std::vector<ScenePlane>& planes) {
  Indices left;
  for (size_t i = 0; i < points.size(); ++i) {
    const PlanePoint& p = points[i];
    if (p.kind == kind && p.depth > 0 && std::isfinite(p.position.x + p.position.y + p.position.z)) left.push_back(i);
  }
  const size_t first = planes.size();
  const size_t least = std::max(s.least_points, static_cast<size_t>(s.least_share * static_cast<double>(left.size())));
  while (left.size() >= least) {
    ScenePlane plane = best_candidate(points, left, s, random);
    Indices near = members(points, left, plane, s);
    if (near.size() < least) return;
    const Vec3d found = plane.normal;
    plane = refine(points, near, plane, found, s);
    near = members(points, left, plane, s);
    plane = refine(points, near, plane, found, s);
    // Points a little farther off are the same surface with a worse depth, and would come again as a plane beside it.
    const Indices taken = members(points, left, plane, s, 2);
    if (taken.empty()) return;
    left = without(left, taken);
    plane.views = views_of(points, near);
    plane.points = near.size();
    if (near.size() < least || plane.views < s.least_views) continue;
    const bool known = std::any_of(planes.begin() + static_cast<std::ptrdiff_t>(first), planes.end(),
                                   [&](const ScenePlane& p) { return same_plane(p, plane, points, near, s); });
    if (!known) planes.push_back(plane);
  }
}

}  // namespace

std::vector<ScenePlane> find_planes(const std::vector<PlanePoint>& points, const PlaneSettings& settings,
                                    uint64_t seed) {
  std::vector<ScenePlane> planes;
  for (const PlaneKind kind : kKinds) {
    find_planes_of(kind, points, settings, Random(seed).fork(static_cast<uint64_t>(kind)), planes);
  }
  std::sort(planes.begin(), planes.end(), [](const ScenePlane& a, const ScenePlane& b) { return a.points > b.points; });
  return planes;
}

}  // namespace aligngs
