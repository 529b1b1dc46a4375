// Regions of cells of a plane: grown, closed, connected.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/plane_grid.h"

namespace aligngs {

/// 1 for the cells of a region, of a grid's size.
using CellRegion = std::vector<uint8_t>;

/// Sums of values over squares of cells, in constant time each.
class SquareSums {
 public:
  SquareSums(const PlaneGrid& grid, const std::vector<float>& values);
  SquareSums(const PlaneGrid& grid, const CellRegion& region);
  /// Over the cells at most `reach` columns and rows away, those of the grid alone.
  double around(int column, int row, int reach) const;

 private:
  template <class T>
  void add_up(const std::vector<T>& values);

  int columns_, rows_;
  std::vector<double> sums_;  ///< of all cells above and to the left
};

/// Cells at most `reach` columns and rows from the region.
CellRegion grown(const CellRegion& region, const PlaneGrid& grid, int reach);

/// With gaps and notches that are at most twice `reach` wide, apart from those within `reach` of the grid's edge.
CellRegion closed(const CellRegion& region, const PlaneGrid& grid, int reach);

/// With the cells that the region encloses.
CellRegion without_holes(const CellRegion& region, const PlaneGrid& grid);

/// The cells of the region that are connected to a seed, over edges of cells. Seeds outside of the region count for
/// nothing.
CellRegion connected_to(const CellRegion& seeds, const CellRegion& region, const PlaneGrid& grid);

/// Cells of the region with a neighbour outside, or at the edge of the grid.
CellRegion rim_of(const CellRegion& region, const PlaneGrid& grid);

}  // namespace aligngs
