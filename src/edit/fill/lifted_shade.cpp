#include "edit/fill/lifted_shade.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "core/quantile.h"
#include "core/spherical_harmonics.h"
#include "edit/fill/surface_colors.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/point_tree.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr float kMostGain = 3;     // deeper shade is something else
constexpr float kLitMost = 1.1f;   // brightness of a lifted Gaussian, relative to the lit surface
constexpr float kBlack = 0.02f;    // of a colour in [0, 1]: nothing is learnt from black
constexpr float kEven = 0.01f;     // of a surface without texture, relative to its brightness
constexpr size_t kFewestLit = 60;  // Gaussians out of reach that tell the light

/// A removed part with the reach of its shade on a plane: its height above the plane.
struct Shader {
  PointTree tree;
  double reach = 0;  ///< scene units
};

std::vector<Shader> shaders_of(const FillRoom& r, const RoomPlane& plane) {
  constexpr double kHighest = 0.9;  // share of a part: strays do not count
  std::vector<Shader> out;
  for (const std::vector<uint8_t>& part : r.parts) {
    if (!r.reaches(part, plane, r.settings.shade_gap)) continue;
    std::vector<Vec3f> points;
    std::vector<double> heights;
    for (size_t i = 0; i < part.size(); ++i) {
      if (!part[i]) continue;
      points.push_back(position_of(r.room.model, i).cast<float>());
      heights.push_back(plane.height(position_of(r.room.model, i)));
    }
    const double reach = std::clamp(quantile_of(std::move(heights), kHighest), r.settings.halo * r.extent,
                                    r.settings.shade_reach * r.extent);
    out.push_back({PointTree(std::move(points)), reach});
  }
  return out;
}

Vec3f sampled(const PlaneGrid& grid, const std::vector<Vec3f>& colors, const Vec2d& place) {
  const double x = std::clamp(place.x - 0.5, 0.0, grid.columns - 1.0),
               y = std::clamp(place.y - 0.5, 0.0, grid.rows - 1.0);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const int i1 = std::min(i + 1, grid.columns - 1), j1 = std::min(j + 1, grid.rows - 1);
  const float fx = static_cast<float>(x - i), fy = static_cast<float>(y - j);
  return (colors[grid.index(i, j)] * (1 - fx) + colors[grid.index(i1, j)] * fx) * (1 - fy) +
         (colors[grid.index(i, j1)] * (1 - fx) + colors[grid.index(i1, j1)] * fx) * fy;
}

float luma_of(const Vec3f& c) { return (c.x + c.y + c.z) / 3; }

/// Mean colours of a plane in [0, 1] on coarse cells, without texture.
struct PlaneLight {
  PlaneGrid grid;
  std::vector<Vec3f> here;     ///< as it is
  std::vector<Vec3f> without;  ///< as it would be without the removed objects; empty where nobody can tell
  float texture = 0;           ///< typical difference of a cell from those around, relative to its brightness
};

/// For a Gaussian with some colour at some place. It becomes no brighter than the lit surface, or keeps its colour.
Vec3f gain_at(const PlaneLight& light, const Vec3d& place, const Vec3f& color) {
  const Vec2d at = light.grid.place_of(place);
  const Vec3f here = sampled(light.grid, light.here, at), without = sampled(light.grid, light.without, at);
  if (luma_of(here) < kBlack || luma_of(without) <= luma_of(here)) return {1, 1, 1};
  // Differences that the texture has by itself are no shade: blossoms and stripes stay.
  constexpr float kUnsure = 2, kSure = 3;  // differences of the texture
  const float excess = luma_of(without) / luma_of(here) - 1;
  const float share = std::clamp(excess / std::max(kEven, light.texture) - kUnsure, 0.f, kSure - kUnsure);
  const float most = std::max(1.f, luma_of(without) * kLitMost / std::max(kBlack, luma_of(color)));
  Vec3f gain;
  for (int c = 0; c < 3; ++c) {
    const float full = std::clamp(without[c] / std::max(kBlack, here[c]), 1 / kMostGain, kMostGain);
    gain[c] = 1 + share * (full - 1);
  }
  const float mean = luma_of(gain);
  return mean > most ? gain * (most / mean) : gain;
}

/// A flag per row: whether it is in reach of a removed part.
std::vector<uint8_t> in_reach(const FillRoom& r, const std::vector<uint32_t>& rows,
                              const std::vector<Shader>& shaders) {
  std::vector<uint8_t> out(rows.size(), 0);
  r.for_each(rows.size(), [&](size_t k) {
    const Vec3f place = position_of(r.room.model, rows[k]).cast<float>();
    out[k] =
        std::any_of(shaders.begin(), shaders.end(), [&](const Shader& s) { return s.tree.any_within(place, s.reach); });
  });
  return out;
}

/// Rows of the classes of walls, floor or ceiling that are nearest to one of the planes and about on it.
std::vector<uint32_t> rows_near(const FillRoom& r, const RoomPlane& plane) {
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < r.room.model.size(); ++i) {
    const uint16_t label = r.room.labels.label[i];
    if (r.gone[i] || label == kNoLabel || label >= r.classes.size() || r.classes[label].shell != plane.kind) continue;
    const Vec3d place = position_of(r.room.model, i);
    const double height = std::fabs(plane.height(place));
    if (height > r.settings.touch * r.extent || !has_surface_at(plane, place, r.settings.touch * r.extent)) continue;
    if (std::none_of(r.planes.begin(), r.planes.end(), [&](const RoomPlane& other) {
          return other.kind == plane.kind && std::fabs(other.height(place)) < height;
        }))
      rows.push_back(i);
  }
  return rows;
}

/// The colours of some carriers, continued over the plane; empty where they are too few.
std::vector<Vec3f> continued(const FillRoom& r, const PlaneGrid& grid, const std::vector<uint32_t>& carriers,
                             const std::vector<uint8_t>& left_out) {
  std::vector<KnownColor> known;
  for (size_t k = 0; k < carriers.size(); ++k) {
    if (left_out[k]) continue;
    const size_t i = carriers[k];
    known.push_back(
        {grid.place_of(position_of(r.room.model, i)), base_color_of(r.room.model, i), opacity_of(r.room.model, i)});
  }
  return known.size() < kFewestLit ? std::vector<Vec3f>() : continued_colors(grid, known);
}

/// Weights 1, 2, 1 along either axis.
std::vector<Vec3f> smoothed(const PlaneGrid& grid, const std::vector<Vec3f>& colors) {
  std::vector<Vec3f> out(colors.size());
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          const float weight = static_cast<float>((2 - std::abs(x)) * (2 - std::abs(y))) / 16;
          const int column = std::clamp(i + x, 0, grid.columns - 1), row = std::clamp(j + y, 0, grid.rows - 1);
          out[grid.index(i, j)] += colors[grid.index(column, row)] * weight;
        }
      }
    }
  }
  return out;
}

/// Typical difference of the cells that some places lie in from their smoothed selves, relative to these.
float texture_of(const PlaneGrid& grid, const std::vector<Vec3f>& colors, const std::vector<Vec3f>& smooth,
                 const std::vector<Vec3d>& places, const std::vector<uint8_t>& left_out) {
  constexpr double kNormal = 1.4826;  // of a normal distribution: standard deviation over median of the size
  std::set<size_t> cells;
  for (size_t k = 0; k < places.size(); ++k) {
    const std::optional<size_t> cell = grid.cell_at(grid.place_of(places[k]));
    if (cell && !left_out[k]) cells.insert(*cell);
  }
  std::vector<double> differences;
  for (const size_t at : cells)
    differences.push_back(static_cast<double>(std::fabs(luma_of(colors[at]) - luma_of(smooth[at])) /
                                              std::max(kBlack, luma_of(smooth[at]))));
  return differences.empty() ? 0 : static_cast<float>(kNormal * quantile_of(std::move(differences), 0.5));
}

PlaneLight plane_light(const FillRoom& r, const RoomPlane& plane, const std::vector<Shader>& shaders) {
  PlaneLight light;
  const std::vector<uint32_t>& carriers = plane.carriers;
  if (carriers.size() < kFewestLit) return light;
  std::vector<Vec3d> points;
  for (const uint32_t i : carriers) points.push_back(position_of(r.room.model, i));
  light.grid = grid_over(points, plane, r.settings.light_cell * r.extent, 0);
  light.here = continued(r, light.grid, carriers, std::vector<uint8_t>(carriers.size(), 0));
  const std::vector<uint8_t> shaded = in_reach(r, carriers, shaders);
  light.without = continued(r, light.grid, carriers, shaded);
  if (light.without.empty()) return light;
  const std::vector<Vec3f> smooth = smoothed(light.grid, light.here);
  light.texture = texture_of(light.grid, light.here, smooth, points, shaded);
  light.here = smooth;
  light.without = smoothed(light.grid, light.without);
  return light;
}

}  // namespace

Vec3f lifted(const Vec3f& harmonic, const Vec3f& gain) {
  const float k = static_cast<float>(kSh0);
  Vec3f out;
  for (int c = 0; c < 3; ++c) out[c] = ((0.5f + k * harmonic[c]) * gain[c] - 0.5f) / k;
  return out;
}

std::vector<Vec3f> lifted_shade(const FillRoom& r) {
  std::vector<Vec3f> gains;
  for (const RoomPlane& plane : r.planes) {
    const std::vector<Shader> shaders = shaders_of(r, plane);
    if (shaders.empty()) continue;
    const PlaneLight light = plane_light(r, plane, shaders);
    if (light.without.empty()) continue;
    if (gains.empty()) gains.assign(r.room.model.size(), Vec3f{1, 1, 1});
    const std::vector<uint32_t> rows = rows_near(r, plane);
    const std::vector<uint8_t> reached = in_reach(r, rows, shaders);
    for (size_t k = 0; k < rows.size(); ++k) {
      if (!reached[k]) continue;
      gains[rows[k]] = gain_at(light, position_of(r.room.model, rows[k]), base_color_of(r.room.model, rows[k]));
    }
  }
  return gains;
}

}  // namespace aligngs
