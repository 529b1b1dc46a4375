#include "edit/fill/furniture_fill.h"

#include <algorithm>
#include <map>
#include <utility>

#include "edit/fill/plane_rectangle.h"
#include "edit/support_fill.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

/// Most of what the object does not cover has a surface. Between the legs of a table nothing has.
bool is_plate(const FillRoom& r, const PlaneGrid& grid, const PlaneRectangle& bounds, const std::vector<float>& object,
              const std::vector<float>& cover) {
  size_t shown = 0, solid = 0;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      const size_t at = grid.index(i, j);
      if (object[at] > r.settings.shadow || !bounds.holds({i + 0.5, j + 0.5}, 0)) continue;
      ++shown;
      solid += cover[at] >= r.settings.covered;
    }
  }
  return static_cast<double>(solid) >= r.settings.plate * static_cast<double>(shown);
}

}  // namespace

std::vector<SurfaceHole> furniture_holes(const FillRoom& r, const std::vector<uint8_t>& part) {
  std::vector<uint8_t> candidates(r.room.model.size(), 0);
  for (size_t i = 0; i < candidates.size(); ++i) {
    const uint16_t label = r.room.labels.label[i];
    candidates[i] = label != kNoLabel && label < r.classes.size() && r.classes[label].furniture;
  }
  std::vector<SurfaceHole> holes;
  for (const SupportPlane& plane : find_supports(r.room, part, r.gone, candidates, r.input.up)) {
    // The furniture that most of the carriers are of.
    std::map<std::pair<uint16_t, uint16_t>, size_t> votes;
    for (const uint32_t i : plane.carriers) ++votes[{r.room.labels.label[i], r.room.labels.instance[i]}];
    const auto [label, instance] = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
                                     return a.second < b.second;
                                   })->first;
    std::vector<Vec3d> points;
    for (size_t i = 0; i < part.size(); ++i) {
      if (part[i]) points.push_back(position_of(r.room.model, i));
    }
    const double cell = r.cell_of(plane.carriers);
    constexpr int kBorder = 12;  // cells around the object whose colours are continued
    const PlaneGrid grid = grid_over(points, {plane.normal, plane.offset}, cell, kBorder * cell);
    const std::vector<uint32_t> rows = r.rows_on(grid, label, instance, r.settings.tolerance);
    if (rows.size() < FillRoom::kFewestCarriers) continue;
    const PlaneRectangle bounds = r.rectangle_on(grid, rows);
    std::vector<float> object(grid.size(), 0.f);
    r.splat_part(part, grid, object);
    const std::vector<float> cover = r.coverage(grid, false);
    if (!is_plate(r, grid, bounds, object, cover)) continue;
    std::vector<uint8_t> hole(grid.size(), 0);
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const size_t at = grid.index(i, j);
        hole[at] = object[at] > r.settings.shadow && cover[at] < r.settings.covered &&
                   bounds.holds({i + 0.5, j + 0.5}, 1) && !r.hidden.is_open(grid.at(i + 0.5, j + 0.5));
      }
    }
    holes.push_back({grid, std::move(hole), r.clean(rows, r.settings.halo)});
  }
  return holes;
}

}  // namespace aligngs
