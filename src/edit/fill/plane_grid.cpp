#include "edit/fill/plane_grid.h"

#include <algorithm>
#include <cmath>

#include "core/perpendicular.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr int kMostCells = 400;  ///< per side

}  // namespace

std::optional<size_t> PlaneGrid::cell_at(const Vec2d& place) const {
  const int i = static_cast<int>(std::floor(place.x)), j = static_cast<int>(std::floor(place.y));
  if (i < 0 || j < 0 || i >= columns || j >= rows) return std::nullopt;
  return index(i, j);
}

PlaneGrid grid_over(const std::vector<Vec3d>& points, const PlaneOf& plane, double cell, double margin) {
  PlaneGrid grid;
  const Vec3d& n = plane.normal;
  grid.normal = n;
  grid.u = perpendicular_to(n);
  grid.v = cross(n, grid.u);
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  for (const Vec3d& p : points) {
    const double c[2] = {dot(grid.u, p), dot(grid.v, p)};
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], c[a] - margin);
      high[a] = std::max(high[a], c[a] + margin);
    }
  }
  grid.cell = std::max(cell, std::max(high[0] - low[0], high[1] - low[1]) / kMostCells);
  grid.columns = std::max(1, static_cast<int>(std::ceil((high[0] - low[0]) / grid.cell)));
  grid.rows = std::max(1, static_cast<int>(std::ceil((high[1] - low[1]) / grid.cell)));
  grid.origin = grid.u * low[0] + grid.v * low[1] + n * plane.offset;
  return grid;
}

void splat(const GaussianModel& model, size_t row, const PlaneGrid& grid, bool flat, std::vector<float>& cover) {
  const Vec3d p{model.positions[3 * row], model.positions[3 * row + 1], model.positions[3 * row + 2]};
  const float* s = &model.log_scales[3 * row];
  const double sigma = std::max(std::exp(static_cast<double>(*std::max_element(s, s + 3))) * 0.7, 0.5 * grid.cell);
  const double height = grid.height_of(p), lift = flat ? 0 : height * height / (4 * grid.cell * grid.cell);
  const Vec2d place = grid.place_of(p);
  const double x = place.x - 0.5, y = place.y - 0.5, r = 2.5 * sigma / grid.cell, opacity = opacity_of(model, row);
  for (int j = std::max(0, static_cast<int>(y - r)); j <= std::min<double>(grid.rows - 1, y + r); ++j) {
    for (int i = std::max(0, static_cast<int>(x - r)); i <= std::min<double>(grid.columns - 1, x + r); ++i) {
      const double d2 = ((i - x) * (i - x) + (j - y) * (j - y)) * grid.cell * grid.cell / (sigma * sigma);
      cover[grid.index(i, j)] += static_cast<float>(opacity * std::exp(-0.5 * d2 - lift));
    }
  }
}

}  // namespace aligngs
