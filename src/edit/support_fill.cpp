#include "edit/support_fill.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/random.h"
#include "scene/plane_fit.h"

namespace aligngs {
namespace {

constexpr float kSolid = 0.3f;        ///< opacity above which a Gaussian is part of a surface
constexpr size_t kFewest = 12;        ///< Gaussians that make a plane believable
constexpr double kOneSide = 0.8;      ///< share of the object on the plane's front side
constexpr size_t kColorSources = 12;  ///< surrounding Gaussians that colour a cell
constexpr int kMostCells = 400;       ///< per side: larger holes have larger cells

Vec3f position(const GaussianModel& model, size_t i) {
  return {model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
}

/// The shortest axis of a Gaussian.
Vec3d axis_of(const GaussianModel& model, size_t i) {
  const float* q = &model.rotations[4 * i];
  const float* s = &model.log_scales[3 * i];
  const int shortest = static_cast<int>(std::min_element(s, s + 3) - s);
  return rotation_matrix(normalized(Quaterniond{q[0], q[1], q[2], q[3]})).column(shortest);
}

struct Surroundings {
  std::vector<uint32_t> rows;  ///< near the selection, solid, not selected
  std::vector<Vec3d> object;   ///< the selection's solid Gaussians
};

Surroundings surroundings_of(const LabelledGaussians& room, const std::vector<uint8_t>& part,
                             const std::vector<uint8_t>& selected, double reach) {
  Surroundings out;
  std::vector<Vec3f> points;
  for (size_t i = 0; i < room.model.size(); ++i) {
    if (!part[i] || opacity_of(room.model, i) < kSolid) continue;
    points.push_back(position(room.model, i));
    out.object.push_back(points.back().cast<double>());
  }
  const PointTree tree(std::move(points));
  std::vector<PointTree::Neighbour> near;
  for (uint32_t i = 0; i < room.model.size(); ++i) {
    if (selected[i] || opacity_of(room.model, i) < kSolid) continue;
    tree.nearest(position(room.model, i), 1, near);
    if (!near.empty() && near[0].distance < reach) out.rows.push_back(i);
  }
  return out;
}

/// The plane that fits its carriers best.
void refit(const LabelledGaussians& room, SupportPlane& plane) {
  std::vector<Vec3d> points;
  for (const uint32_t i : plane.carriers) points.push_back(position(room.model, i).cast<double>());
  const PlaneFit fit = fit_plane(points, {}, plane.normal);
  plane.normal = fit.normal;
  plane.offset = dot(fit.normal, fit.centre);
}

std::vector<uint32_t> carriers_of(const LabelledGaussians& room, const std::vector<uint32_t>& rows, const Vec3d& normal,
                                  double offset, double tolerance) {
  constexpr double kFacing = 0.7;  // the disc lies in the plane to within 45 degrees
  std::vector<uint32_t> out;
  for (const uint32_t i : rows) {
    if (std::fabs(dot(normal, position(room.model, i).cast<double>()) - offset) < tolerance &&
        std::fabs(dot(normal, axis_of(room.model, i))) > kFacing) {
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
  const Vec3d u = normalized(cross(std::fabs(n.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, n)), v = cross(n, u);
  std::set<int> directions;
  for (const uint32_t i : plane.carriers) {
    const Vec3d d = position(room.model, i).cast<double>() - centre;
    directions.insert(static_cast<int>(std::floor(std::atan2(dot(v, d), dot(u, d)) / kEighthTurn)));
  }
  return directions.size() >= kLeastDirections;
}

/// Cells of a rectangle of the plane.
struct Grid {
  Vec3d u, v, origin;
  double cell = 1;
  int columns = 0, rows = 0;
  Vec3d at(double column, double row) const { return origin + u * (column * cell) + v * (row * cell); }
  size_t index(int column, int row) const { return static_cast<size_t>(row) * columns + column; }
};

Grid grid_over(const std::vector<Vec3d>& points, const SupportPlane& plane, double cell) {
  Grid grid;
  const Vec3d& n = plane.normal;
  grid.u = normalized(cross(std::fabs(n.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, n));
  grid.v = cross(n, grid.u);
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  for (const Vec3d& p : points) {
    const double c[2] = {dot(grid.u, p), dot(grid.v, p)};
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], c[a] - 2 * cell);
      high[a] = std::max(high[a], c[a] + 2 * cell);
    }
  }
  grid.cell = std::max(cell, std::max(high[0] - low[0], high[1] - low[1]) / kMostCells);
  grid.columns = static_cast<int>(std::ceil((high[0] - low[0]) / grid.cell));
  grid.rows = static_cast<int>(std::ceil((high[1] - low[1]) / grid.cell));
  grid.origin = grid.u * low[0] + grid.v * low[1] + n * plane.offset;
  return grid;
}

/// Adds opacity-weighted discs of Gaussians to a grid; `flat` ignores how far they are from the plane.
void splat(const GaussianModel& model, uint32_t row, const Grid& grid, const Vec3d& normal, bool flat,
           std::vector<float>& cover) {
  const Vec3d p = position(model, row).cast<double>() - grid.origin;
  const float* s = &model.log_scales[3 * static_cast<size_t>(row)];
  const double sigma = std::max(std::exp(static_cast<double>(*std::max_element(s, s + 3))) * 0.7, 0.5 * grid.cell);
  const double height = dot(normal, p), lift = flat ? 0 : height * height / (4 * grid.cell * grid.cell);
  const double x = dot(grid.u, p) / grid.cell - 0.5, y = dot(grid.v, p) / grid.cell - 0.5, r = 2.5 * sigma / grid.cell;
  const double opacity = opacity_of(model, row);
  for (int j = std::max(0, static_cast<int>(y - r)); j <= std::min<double>(grid.rows - 1, y + r); ++j) {
    for (int i = std::max(0, static_cast<int>(x - r)); i <= std::min<double>(grid.columns - 1, x + r); ++i) {
      const double d2 = ((i - x) * (i - x) + (j - y) * (j - y)) * grid.cell * grid.cell / (sigma * sigma);
      cover[grid.index(i, j)] += static_cast<float>(opacity * std::exp(-0.5 * d2 - lift));
    }
  }
}

std::vector<uint8_t> widened(const std::vector<uint8_t>& cells, const Grid& grid) {
  std::vector<uint8_t> out = cells;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          const int x = i + di, y = j + dj;
          if (x >= 0 && y >= 0 && x < grid.columns && y < grid.rows && cells[grid.index(x, y)])
            out[grid.index(i, j)] = 1;
        }
      }
    }
  }
  return out;
}

/// Harmonics of a place on the plane: mean of the nearest carriers, by inverse squared distance.
class CarrierColors {
 public:
  CarrierColors(const LabelledGaussians& room, const SupportPlane& plane)
      : room_(room), rows_(plane.carriers), tree_(points()) {}
  uint32_t mix(const Vec3d& place, float* sh) const {
    std::vector<PointTree::Neighbour> near;
    tree_.nearest(place.cast<float>(), kColorSources, near);
    std::fill_n(sh, 3 * kShCoefficients, 0.f);
    float total = 0;
    const float softening = 1e-4f * static_cast<float>(room_.extent);
    for (const PointTree::Neighbour& n : near) {
      const float weight = 1 / (n.distance * n.distance + softening * softening);
      total += weight;
      const float* source = &room_.model.sh[size_t(3) * kShCoefficients * rows_[n.index]];
      for (int k = 0; k < 3 * kShCoefficients; ++k) sh[k] += weight * source[k];
    }
    for (int k = 0; k < 3 * kShCoefficients; ++k) sh[k] /= total;
    return rows_[near.front().index];
  }

 private:
  std::vector<Vec3f> points() const {
    std::vector<Vec3f> out;
    for (const uint32_t i : rows_) out.push_back(position(room_.model, i));
    return out;
  }
  const LabelledGaussians& room_;
  const std::vector<uint32_t>& rows_;
  PointTree tree_;
};

void add_gaussian(const LabelledGaussians& room, const Grid& grid, const Vec3d& normal, const Vec3d& place,
                  const CarrierColors& colors, SupportPatch& patch) {
  GaussianModel& g = patch.gaussians;
  const size_t i = g.size();
  g.resize(i + 1);
  const uint32_t source = colors.mix(place, &g.sh[size_t(3) * kShCoefficients * i]);
  patch.sources.push_back(source);
  for (int a = 0; a < 3; ++a) g.positions[3 * i + static_cast<size_t>(a)] = static_cast<float>(place[a]);
  const float wide = static_cast<float>(std::log(0.75 * grid.cell)), flat = wide + std::log(0.1f);
  const float scales[3] = {wide, wide, flat};
  std::copy_n(scales, 3, &g.log_scales[3 * i]);
  const Quaterniond q = quaternion_from_z_to(normal);
  const float rotation[4] = {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                             static_cast<float>(q.z)};
  std::copy_n(rotation, 4, &g.rotations[4 * i]);
  g.opacity_logits[i] = 3;  // opacity 0.95: with its neighbours' shares nothing shows through
  const size_t channels = static_cast<size_t>(g.semantic_channels);
  std::copy_n(room.model.semantics.begin() + static_cast<std::ptrdiff_t>(source * channels), channels,
              g.semantics.begin() + static_cast<std::ptrdiff_t>(i * channels));
}

void add_patch_mesh(const LabelledGaussians& room, const Grid& grid, const Vec3d& normal,
                    const std::vector<uint8_t>& cells, const CarrierColors& colors, TriangleMesh& mesh) {
  constexpr uint32_t kUnused = 0xffffffffu;
  std::vector<uint32_t> corner(static_cast<size_t>(grid.columns + 1) * (grid.rows + 1), kUnused);
  const auto vertex = [&](int i, int j) {
    uint32_t& id = corner[static_cast<size_t>(j) * (grid.columns + 1) + i];
    if (id != kUnused) return id;
    id = static_cast<uint32_t>(mesh.vertices.size());
    float sh[3 * kShCoefficients];
    const Vec3d place = grid.at(i, j);
    const uint32_t source = colors.mix(place, sh);
    std::array<uint8_t, 3> color;
    for (size_t c = 0; c < 3; ++c) {
      color[c] = static_cast<uint8_t>(std::lround(255 * std::clamp(0.5f + static_cast<float>(kSh0) * sh[c], 0.f, 1.f)));
    }
    mesh.vertices.push_back(place.cast<float>());
    mesh.normals.push_back(normal.cast<float>());
    mesh.colors.push_back(color);
    mesh.labels.push_back(room.labels.label[source]);
    return id;
  };
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      if (!cells[grid.index(i, j)]) continue;
      const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
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
    Vec3d normal = axis_of(room.model, proposer);
    if (!allowed(normal)) continue;
    double offset = dot(normal, position(room.model, proposer).cast<double>());
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
    if (!selected[i] || opacity_of(room.model, i) < kSolid) continue;
    rows.push_back(i);
    points.push_back(position(room.model, i));
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
                                        const std::vector<uint8_t>& selected, const std::optional<Vec3d>& up,
                                        const SupportOptions& options) {
  constexpr double kOtherDirection = 0.4;  // cosine: 66 degrees
  constexpr double kLooser = 1.5;          // a surface behind an object is seen at its edges only, and badly
  const Surroundings around = surroundings_of(room, part, selected, options.ring * room.extent);
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

SupportPatch fill_on_plane(const LabelledGaussians& room, const std::vector<uint8_t>& part,
                           const std::vector<uint8_t>& selected, const SupportPlane& plane,
                           const SupportOptions& options) {
  SupportPatch patch;
  patch.gaussians.semantic_channels = room.model.semantic_channels;
  patch.gaussians.sh_degree = room.model.sh_degree;
  std::vector<Vec3d> footprint;
  for (size_t i = 0; i < room.model.size(); ++i) {
    if (part[i]) footprint.push_back(position(room.model, i).cast<double>());
  }
  if (footprint.empty() || plane.carriers.empty()) return patch;
  std::vector<float> spacing;
  {
    std::vector<Vec3f> points;
    for (const uint32_t i : plane.carriers) points.push_back(position(room.model, i));
    const PointTree tree(points);
    std::vector<PointTree::Neighbour> near;
    for (const Vec3f& p : points) {
      tree.nearest(p, 2, near);
      spacing.push_back(near.back().distance);
    }
  }
  std::nth_element(spacing.begin(), spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2), spacing.end());
  const Grid grid = grid_over(
      footprint, plane,
      std::clamp<double>(spacing[spacing.size() / 2], options.cell_min * room.extent, options.cell_max * room.extent));
  const size_t cells = static_cast<size_t>(grid.columns) * grid.rows;
  std::vector<float> object(cells, 0.f), rest(cells, 0.f);
  const double tolerance = 2 * options.tolerance * room.extent;
  for (uint32_t i = 0; i < room.model.size(); ++i) {
    if (part[i]) {
      splat(room.model, i, grid, plane.normal, true, object);
    } else if (!selected[i] &&
               std::fabs(dot(plane.normal, position(room.model, i).cast<double>()) - plane.offset) < tolerance) {
      splat(room.model, i, grid, plane.normal, false, rest);
    }
  }
  constexpr float kShadow = 0.2f, kCovered = 0.6f;  // accumulated opacity
  std::vector<uint8_t> hole(cells);
  for (size_t c = 0; c < cells; ++c) hole[c] = object[c] > kShadow && rest[c] < kCovered;
  const CarrierColors colors(room, plane);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      if (hole[grid.index(i, j)]) add_gaussian(room, grid, plane.normal, grid.at(i + 0.5, j + 0.5), colors, patch);
    }
  }
  if (!patch.sources.empty()) add_patch_mesh(room, grid, plane.normal, widened(hole, grid), colors, patch.mesh);
  return patch;
}

}  // namespace aligngs
