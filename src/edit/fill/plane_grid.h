// Square cells of a rectangle of a plane.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// The plane normal . x = offset.
struct PlaneOf {
  Vec3d normal;
  double offset = 0;
  /// Distance of a place before the plane, scene units; less than 0 behind it.
  double height(const Vec3d& place) const { return dot(normal, place) - offset; }
};

struct PlaneGrid {
  Vec3d u, v, normal;  ///< unit, world; u x v is the normal
  Vec3d origin;        ///< corner of cell (0, 0), on the plane
  double cell = 1;     ///< edge of a cell, scene units
  int columns = 0, rows = 0;

  size_t size() const { return static_cast<size_t>(columns) * static_cast<size_t>(rows); }
  size_t index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
  }
  /// World position of a place, in cells; the middle of cell (i, j) is at (i + 0.5, j + 0.5).
  Vec3d at(double column, double row) const { return origin + u * (column * cell) + v * (row * cell); }
  /// The inverse of at(), of the projection of a point on the plane.
  Vec2d place_of(const Vec3d& p) const { return {dot(u, p - origin) / cell, dot(v, p - origin) / cell}; }
  /// Index of the cell that holds a place, in cells; empty outside of the grid.
  std::optional<size_t> cell_at(const Vec2d& place) const;
  double height_of(const Vec3d& p) const { return dot(normal, p - origin); }
};

/// Cells over the projections of `points`, and `margin` scene units more on every side. Cells are larger than `cell`
/// where a side would have more than 400.
PlaneGrid grid_over(const std::vector<Vec3d>& points, const PlaneOf& plane, double cell, double margin);

/// Adds the opacity of a Gaussian to the cells that it covers. `flat`: how far it is from the plane does not matter.
void splat(const GaussianModel& model, size_t row, const PlaneGrid& grid, bool flat, std::vector<float>& cover);

}  // namespace aligngs
