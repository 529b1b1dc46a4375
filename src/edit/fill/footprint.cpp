#include "edit/fill/footprint.h"

#include "edit/fill/grid_regions.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {

bool Footprint::holds(const Vec3d& place) const {
  if (cells.empty()) return false;
  const std::optional<size_t> cell = grid.cell_at(grid.place_of(place));
  return cell && cells[*cell];
}

Footprint footprint_of(const GaussianModel& model, const std::vector<uint32_t>& rows, const PlaneOf& plane, double cell,
                       float least) {
  Footprint out;
  if (rows.empty()) return out;
  std::vector<Vec3d> points;
  for (const uint32_t i : rows) points.push_back(position_of(model, i));
  out.grid = grid_over(points, plane, cell, cell);
  std::vector<float> cover(out.grid.size(), 0.f);
  for (const uint32_t i : rows) splat(model, i, out.grid, true, cover);
  for (const float c : cover) out.cells.push_back(c >= least);
  out.cells = without_holes(out.cells, out.grid);
  return out;
}

}  // namespace aligngs
