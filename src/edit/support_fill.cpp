#include "edit/support_fill.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/perpendicular.h"
#include "core/random.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/point_tree.h"
#include "scene/plane_fit.h"

namespace aligngs {
namespace {

constexpr size_t kFewest = 12;    ///< Gaussians that make a plane believable
constexpr double kOneSide = 0.8;  ///< share of the object on the plane's front side

struct Surroundings {
  std::vector<uint32_t> rows;  ///< candidates near the selection, solid, not selected
  std::vector<Vec3d> object;   ///< the selection's solid Gaussians
};

Surroundings surroundings_of(const LabelledGaussians& room, const std::vector<uint8_t>& part,
                             const std::vector<uint8_t>& selected, const std::vector<uint8_t>& candidates,
                             double reach) {
  Surroundings out;
  std::vector<Vec3f> points;
  for (size_t i = 0; i < room.model.size(); ++i) {
    if (!part[i] || opacity_of(room.model, i) < kSolidOpacity) continue;
    points.push_back(position_of(room.model, i).cast<float>());
    out.object.push_back(points.back().cast<double>());
  }
  const PointTree tree(std::move(points));
  std::vector<PointTree::Neighbour> near;
  for (uint32_t i = 0; i < room.model.size(); ++i) {
    if (selected[i] || !candidates[i] || opacity_of(room.model, i) < kSolidOpacity) continue;
    tree.nearest(position_of(room.model, i).cast<float>(), 1, near);
    if (!near.empty() && near[0].distance < reach) out.rows.push_back(i);
  }
  return out;
}

/// The plane that fits its carriers best.
void refit(const LabelledGaussians& room, SupportPlane& plane) {
  std::vector<Vec3d> points;
  for (const uint32_t i : plane.carriers) points.push_back(position_of(room.model, i));
  const PlaneFit fit = fit_plane(points, {}, plane.normal);
  plane.normal = fit.normal;
  plane.offset = dot(fit.normal, fit.centre);
}

std::vector<uint32_t> carriers_of(const LabelledGaussians& room, const std::vector<uint32_t>& rows, const Vec3d& normal,
                                  double offset, double tolerance) {
  constexpr double kFacing = 0.7;  // the disc lies in the plane to within 45 degrees
  std::vector<uint32_t> out;
  for (const uint32_t i : rows) {
    if (std::fabs(dot(normal, position_of(room.model, i)) - offset) < tolerance &&
        std::fabs(dot(normal, shortest_axis(room.model, i))) > kFacing) {
      out.push_back(i);
    }
  }
  return out;
}

/// Whether the carriers lie around the object on their plane, in at least three of eight directions. Behind a pillow
/// the headboard does; the side of a box near by does not, and has no hole.
bool surrounds(const LabelledGaussians& room, const SupportPlane& plane, const std::vector<Vec3d>& object) {
  constexpr double kEighthTurn = 0.78539816339744831;  // radians
  constexpr size_t kLeastDirections = 3;
  Vec3d centre;
  for (const Vec3d& p : object) centre += p * (1.0 / static_cast<double>(object.size()));
  const Vec3d& n = plane.normal;
  const Vec3d u = perpendicular_to(n), v = cross(n, u);
  std::set<int> directions;
  for (const uint32_t i : plane.carriers) {
    const Vec3d d = position_of(room.model, i) - centre;
    directions.insert(static_cast<int>(std::floor(std::atan2(dot(v, d), dot(u, d)) / kEighthTurn)));
  }
  return directions.size() >= kLeastDirections;
}

std::optional<SupportPlane> best_plane(const LabelledGaussians& room, const Surroundings& around,
                                       const std::optional<Vec3d>& up, const SupportOptions& options,
                                       const std::function<bool(const Vec3d&)>& allowed) {
  if (around.rows.size() < kFewest || around.object.empty()) return std::nullopt;
  const double tolerance = options.tolerance * room.extent;
  Random random(options.seed);
  SupportPlane best;
  double best_score = 0;
  const int n = static_cast<int>(around.rows.size());
  for (int trial = 0; trial < options.trials; ++trial) {
    // One Gaussian proposes a plane by itself: its position and its shortest axis.
    const uint32_t proposer = around.rows[static_cast<size_t>(random.below(n))];
    Vec3d normal = shortest_axis(room.model, proposer);
    if (!allowed(normal)) continue;
    double offset = dot(normal, position_of(room.model, proposer));
    size_t front = 0;
    for (const Vec3d& p : around.object) front += dot(normal, p) > offset;
    if (2 * front < around.object.size()) {
      normal = -normal;
      offset = -offset;
    }
    front = 0;
    for (const Vec3d& p : around.object) front += dot(normal, p) > offset - tolerance;
    if (static_cast<double>(front) < kOneSide * static_cast<double>(around.object.size())) continue;
    std::vector<uint32_t> carriers = carriers_of(room, around.rows, normal, offset, tolerance);
    const double score = static_cast<double>(carriers.size()) * (1 + (up ? std::max(0.0, dot(normal, *up)) : 0));
    if (carriers.size() >= kFewest && score > best_score) {
      best_score = score;
      best = {normal, offset, std::move(carriers)};
    }
  }
  if (best.carriers.empty()) return std::nullopt;
  refit(room, best);
  best.carriers = carriers_of(room, around.rows, best.normal, best.offset, tolerance);
  if (best.carriers.size() < kFewest) return std::nullopt;
  return best;
}

}  // namespace

std::vector<std::vector<uint8_t>> connected_parts(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                                  const SupportOptions& options) {
  constexpr size_t kNeighbours = 12, kSmallest = 20;
  std::vector<uint32_t> rows;
  std::vector<Vec3f> points;
  for (uint32_t i = 0; i < selected.size(); ++i) {
    if (!selected[i] || opacity_of(room.model, i) < kSolidOpacity) continue;
    rows.push_back(i);
    points.push_back(position_of(room.model, i).cast<float>());
  }
  const PointTree tree(points);
  std::vector<std::vector<uint32_t>> links(rows.size());
  std::vector<PointTree::Neighbour> near;
  for (uint32_t i = 0; i < rows.size(); ++i) {
    tree.nearest(points[i], kNeighbours, near);
    for (const PointTree::Neighbour& n : near) {
      if (n.distance > options.link * room.extent) continue;
      links[i].push_back(n.index);
      links[n.index].push_back(i);
    }
  }
  std::vector<std::vector<uint8_t>> parts;
  std::vector<uint8_t> seen(rows.size(), 0);
  for (uint32_t first = 0; first < rows.size(); ++first) {
    std::vector<uint32_t> members;
    if (!seen[first]) members.push_back(first);
    seen[first] = 1;
    for (size_t k = 0; k < members.size(); ++k) {
      for (const uint32_t j : links[members[k]]) {
        if (seen[j]) continue;
        seen[j] = 1;
        members.push_back(j);
      }
    }
    if (members.size() < kSmallest) continue;
    parts.emplace_back(selected.size(), uint8_t(0));
    for (const uint32_t m : members) parts.back()[rows[m]] = 1;
  }
  return parts;
}

std::vector<SupportPlane> find_supports(const LabelledGaussians& room, const std::vector<uint8_t>& part,
                                        const std::vector<uint8_t>& selected, const std::vector<uint8_t>& candidates,
                                        const std::optional<Vec3d>& up, const SupportOptions& options) {
  constexpr double kOtherDirection = 0.4;  // cosine: 66 degrees
  constexpr double kLooser = 1.5;          // things behind an object are seen at its edges only, and badly
  const Surroundings around = surroundings_of(room, part, selected, candidates, options.ring * room.extent);
  std::vector<SupportPlane> planes;
  const auto best = best_plane(room, around, up, options, [](const Vec3d&) { return true; });
  if (!best) return planes;
  planes.push_back(*best);
  SupportOptions looser = options;
  looser.tolerance *= kLooser;
  const auto second = best_plane(room, around, up, looser,
                                 [&](const Vec3d& n) { return std::fabs(dot(n, best->normal)) < kOtherDirection; });
  if (!second) return planes;
  if (surrounds(room, *second, around.object)) planes.push_back(*second);
  return planes;
}

}  // namespace aligngs
