#include "edit/fill/surface_patch.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/spherical_harmonics.h"
#include "edit/fill/grid_regions.h"
#include "edit/fill/hole_texture.h"
#include "edit/fill/lifted_shade.h"
#include "edit/fill/surface_colors.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/point_tree.h"

namespace aligngs {
namespace {

constexpr size_t kPatchColorNumbers = size_t(3) * kShCoefficients;  // numbers of a Gaussian's colour
constexpr float kLeastSpread = 0.05f;                               // of the harmonic: noise of an even surface
constexpr double kNarrowest = 0.3;                                  // cells: a pixel's width is in every splat

Vec3f constant_of(const GaussianModel& model, size_t i) {
  const float* sh = &model.sh[kPatchColorNumbers * i];
  return {sh[0], sh[1], sh[2]};
}

/// Carriers whose colour is like that of those around them: a stray one of another thing would leave a stain.
std::vector<uint32_t> without_strays(const LabelledGaussians& room, const std::vector<uint32_t>& carriers) {
  constexpr size_t kNeighbours = 12;
  constexpr float kSpreads = 4;  // median absolute deviations
  if (carriers.size() <= kNeighbours) return carriers;
  std::vector<Vec3f> points;
  for (const uint32_t i : carriers) points.push_back(position_of(room.model, i).cast<float>());
  const PointTree tree(points);
  std::vector<PointTree::Neighbour> near;
  std::vector<uint32_t> out;
  std::vector<float> values;
  for (size_t k = 0; k < carriers.size(); ++k) {
    tree.nearest(points[k], kNeighbours, near);
    const Vec3f own = constant_of(room.model, carriers[k]);
    bool stray = false;
    for (int c = 0; c < 3; ++c) {
      values.clear();
      for (const PointTree::Neighbour& n : near) values.push_back(constant_of(room.model, carriers[n.index])[c]);
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      const float median = *middle;
      for (float& v : values) v = std::fabs(v - median);
      std::nth_element(values.begin(), middle, values.end());
      stray |= std::fabs(own[c] - median) > kSpreads * std::max(*middle, kLeastSpread);
    }
    if (!stray) out.push_back(carriers[k]);
  }
  return out.empty() ? carriers : out;
}

/// The part of the plane that a Gaussian covers, seen from in front.
CellSpread spread_of(const GaussianModel& model, size_t row, const PlaneGrid& grid) {
  const float* q = &model.rotations[4 * row];
  const Mat3d axes = rotation_matrix(normalized(Quaterniond{q[0], q[1], q[2], q[3]}));
  CellSpread spread{kNarrowest * kNarrowest, 0, kNarrowest * kNarrowest};
  for (int a = 0; a < 3; ++a) {
    const double deviation =
        std::exp(static_cast<double>(model.log_scales[3 * row + static_cast<size_t>(a)])) / grid.cell;
    const Vec3d axis = Vec3d{axes(0, a), axes(1, a), axes(2, a)} * deviation;
    const double x = dot(grid.u, axis), y = dot(grid.v, axis);
    spread.xx += x * x;
    spread.xy += x * y;
    spread.yy += y * y;
  }
  return spread;
}

std::vector<KnownColor> known_colors(const GaussianModel& model, const PlaneGrid& grid,
                                     const std::vector<uint32_t>& rows, const std::vector<Vec3f>& gains) {
  std::vector<KnownColor> known;
  for (const uint32_t i : rows) {
    const Vec3f color = gains.empty() ? constant_of(model, i) : lifted(constant_of(model, i), gains[i]);
    known.push_back({grid.place_of(position_of(model, i)), color, opacity_of(model, i), spread_of(model, i, grid)});
  }
  return known;
}

/// Light continues smoothly from the carriers without strays. A texture continues from all of them: a joint between
/// tiles has a colour of its own.
std::vector<Vec3f> hole_colors(const LabelledGaussians& room, const SurfaceHole& open,
                               const std::vector<uint32_t>& without_strays, const std::vector<Vec3f>& gains) {
  const PlaneGrid& grid = open.grid;
  const std::vector<Vec3f> texture = hole_texture(
      grid, open.cells, known_colors(room.model, grid, open.carriers, gains), {room.extent, open.is_floor});
  std::vector<KnownColor> known = known_colors(room.model, grid, without_strays, gains);
  if (texture.empty()) return continued_colors(grid, known);
  for (KnownColor& k : known) {
    if (const std::optional<size_t> cell = grid.cell_at(k.place)) k.color = k.color - texture[*cell];
  }
  std::vector<Vec3f> colors = continued_colors(grid, known);
  for (size_t at = 0; at < colors.size(); ++at) colors[at] += texture[at];
  return colors;
}

/// Harmonics of the carriers but for the constant one: how the surface shines, the same everywhere.
std::vector<float> mean_shine(const GaussianModel& model, const std::vector<uint32_t>& carriers) {
  std::vector<float> mean(kPatchColorNumbers, 0.f);
  for (const uint32_t i : carriers) {
    for (size_t k = 3; k < kPatchColorNumbers; ++k)
      mean[k] += model.sh[kPatchColorNumbers * i + k] / static_cast<float>(carriers.size());
  }
  return mean;
}

void add_gaussian(const LabelledGaussians& room, const PlaneGrid& grid, const Vec3d& place, const Vec3f& color,
                  const std::vector<float>& shine, uint32_t source, SupportPatch& patch) {
  GaussianModel& g = patch.gaussians;
  const size_t i = g.size();
  g.resize(i + 1);
  patch.sources.push_back(source);
  std::copy(shine.begin(), shine.end(), g.sh.begin() + static_cast<std::ptrdiff_t>(kPatchColorNumbers * i));
  for (int a = 0; a < 3; ++a) {
    g.positions[3 * i + static_cast<size_t>(a)] = static_cast<float>(place[a]);
    g.sh[kPatchColorNumbers * i + static_cast<size_t>(a)] = color[a];
  }
  const float wide = static_cast<float>(std::log(static_cast<double>(kNewDeviation) * grid.cell)),
              flat = wide + std::log(0.1f);
  const float scales[3] = {wide, wide, flat};
  std::copy_n(scales, 3, &g.log_scales[3 * i]);
  const Quaterniond q = quaternion_from_z_to(grid.normal);
  const float rotation[4] = {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                             static_cast<float>(q.z)};
  std::copy_n(rotation, 4, &g.rotations[4 * i]);
  g.opacity_logits[i] = 3;  // opacity 0.95: with its neighbours' shares nothing shows through
  const size_t channels = static_cast<size_t>(g.semantic_channels);
  std::copy_n(room.model.semantics.begin() + static_cast<std::ptrdiff_t>(source * channels), channels,
              g.semantics.begin() + static_cast<std::ptrdiff_t>(i * channels));
}

void add_mesh(const LabelledGaussians& room, const PlaneGrid& grid, const std::vector<uint8_t>& cells,
              const std::vector<Vec3f>& colors, uint32_t source, TriangleMesh& mesh) {
  constexpr uint32_t kUnused = 0xffffffffu;
  std::vector<uint32_t> corner(static_cast<size_t>(grid.columns + 1) * static_cast<size_t>(grid.rows + 1), kUnused);
  const auto vertex = [&](int i, int j) {
    uint32_t& id = corner[static_cast<size_t>(j) * static_cast<size_t>(grid.columns + 1) + static_cast<size_t>(i)];
    if (id != kUnused) return id;
    id = static_cast<uint32_t>(mesh.vertices.size());
    const Vec3f sh = colors[grid.index(std::min(i, grid.columns - 1), std::min(j, grid.rows - 1))];
    std::array<uint8_t, 3> color;
    for (size_t c = 0; c < 3; ++c) {
      color[c] = static_cast<uint8_t>(
          std::lround(255 * std::clamp(0.5f + static_cast<float>(kSh0) * sh[static_cast<int>(c)], 0.f, 1.f)));
    }
    mesh.vertices.push_back(grid.at(i, j).cast<float>());
    mesh.normals.push_back(grid.normal.cast<float>());
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

/// Rows whose colour stays, or all where none stays. A row that a lighter copy replaces is no source. The copy
/// follows selections that were drawn by hand, and the fill must not.
std::vector<uint32_t> unchanged(const std::vector<uint32_t>& rows, const std::vector<Vec3f>& gains) {
  std::vector<uint32_t> out;
  for (const uint32_t i : rows) {
    if (gains.empty() || (gains[i].x == 1 && gains[i].y == 1 && gains[i].z == 1)) out.push_back(i);
  }
  return out.empty() ? rows : out;
}

}  // namespace

SupportPatch make_patch(const LabelledGaussians& room, const SurfaceHole& open, const std::vector<Vec3f>& gains) {
  const PlaneGrid& grid = open.grid;
  const std::vector<uint8_t>& hole = open.cells;
  const std::vector<uint32_t>& carriers = open.carriers;
  SupportPatch patch;
  patch.gaussians.semantic_channels = room.model.semantic_channels;
  patch.gaussians.sh_degree = room.model.sh_degree;
  if (carriers.empty() || open.is_empty()) return patch;
  const std::vector<uint32_t> rows = without_strays(room, carriers);
  const std::vector<uint32_t> sources = unchanged(rows, gains);
  std::vector<Vec3f> points;
  for (const uint32_t i : sources) points.push_back(position_of(room.model, i).cast<float>());
  std::vector<Vec3f> colors = hole_colors(room, open, rows, gains);
  const std::vector<float> shine = mean_shine(room.model, rows);
  const PointTree tree(points);
  std::vector<PointTree::Neighbour> near;
  const auto source_at = [&](const Vec3d& place) {
    tree.nearest(place.cast<float>(), 1, near);
    return sources[near.front().index];
  };
  if (colors.empty()) {  // all carriers are outside of the grid: the nearest one's colour
    colors.assign(grid.size(), constant_of(room.model, source_at(grid.at(0.5 * grid.columns, 0.5 * grid.rows))));
  }
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      if (!hole[grid.index(i, j)]) continue;
      const Vec3d place = grid.at(i + 0.5, j + 0.5);
      add_gaussian(room, grid, place, colors[grid.index(i, j)], shine, source_at(place), patch);
    }
  }
  add_mesh(room, grid, grown(hole, grid, 1), colors, source_at(grid.at(0.5 * grid.columns, 0.5 * grid.rows)),
           patch.mesh);
  return patch;
}

void add_lifted(const LabelledGaussians& room, uint32_t row, const Vec3f& gain, SupportPatch& patch) {
  const GaussianModel& from = room.model;
  GaussianModel& to = patch.gaussians;
  const size_t i = to.size(), r = row, channels = static_cast<size_t>(to.semantic_channels);
  to.resize(i + 1);
  patch.sources.push_back(row);
  const auto copy = [&](const std::vector<float>& source, std::vector<float>& target, size_t count) {
    std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(count * r), count,
                target.begin() + static_cast<std::ptrdiff_t>(count * i));
  };
  copy(from.positions, to.positions, 3);
  copy(from.log_scales, to.log_scales, 3);
  copy(from.rotations, to.rotations, 4);
  copy(from.opacity_logits, to.opacity_logits, 1);
  copy(from.sh, to.sh, kPatchColorNumbers);
  copy(from.semantics, to.semantics, channels);
  float* sh = &to.sh[kPatchColorNumbers * i];
  const Vec3f constant = lifted(constant_of(from, row), gain);
  for (size_t k = 0; k < kPatchColorNumbers; ++k)
    sh[k] = k < 3 ? constant[static_cast<int>(k)] : sh[k] * gain[static_cast<int>(k % 3)];
}

void append_patch(SupportPatch& patch, const SupportPatch& more) {
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  patch.gaussians.semantic_channels = more.gaussians.semantic_channels;
  patch.gaussians.sh_degree = more.gaussians.sh_degree;
  append(patch.gaussians.positions, more.gaussians.positions);
  append(patch.gaussians.log_scales, more.gaussians.log_scales);
  append(patch.gaussians.rotations, more.gaussians.rotations);
  append(patch.gaussians.opacity_logits, more.gaussians.opacity_logits);
  append(patch.gaussians.sh, more.gaussians.sh);
  append(patch.gaussians.semantics, more.gaussians.semantics);
  append(patch.sources, more.sources);
  const uint32_t base = static_cast<uint32_t>(patch.mesh.vertices.size());
  append(patch.mesh.vertices, more.mesh.vertices);
  append(patch.mesh.normals, more.mesh.normals);
  append(patch.mesh.colors, more.mesh.colors);
  append(patch.mesh.labels, more.mesh.labels);
  for (const auto& t : more.mesh.triangles) patch.mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

}  // namespace aligngs
