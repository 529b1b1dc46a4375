#include "edit/fill/grid_regions.h"

#include <algorithm>

#include "edit/fill/hole_gaps.h"

namespace aligngs {
namespace {

/// Calls visit(index) for the neighbours over an edge.
template <class Visit>
void visit_neighbours(const PlaneGrid& grid, size_t cell, const Visit& visit) {
  const size_t columns = static_cast<size_t>(grid.columns), column = cell % columns;
  if (column > 0) visit(cell - 1);
  if (column + 1 < columns) visit(cell + 1);
  if (cell >= columns) visit(cell - columns);
  if (cell + columns < grid.size()) visit(cell + columns);
}

}  // namespace

SquareSums::SquareSums(const PlaneGrid& grid, const std::vector<float>& values)
    : columns_(grid.columns), rows_(grid.rows) {
  add_up(values);
}

SquareSums::SquareSums(const PlaneGrid& grid, const CellRegion& region) : columns_(grid.columns), rows_(grid.rows) {
  add_up(region);
}

template <class T>
void SquareSums::add_up(const std::vector<T>& values) {
  const size_t stride = static_cast<size_t>(columns_) + 1;
  sums_.assign(stride * (static_cast<size_t>(rows_) + 1), 0);
  for (size_t row = 0; row < static_cast<size_t>(rows_); ++row) {
    double of_row = 0;
    for (size_t column = 0; column + 1 < stride; ++column) {
      of_row += values[row * (stride - 1) + column];
      sums_[(row + 1) * stride + column + 1] = sums_[row * stride + column + 1] + of_row;
    }
  }
}

double SquareSums::around(int column, int row, int reach) const {
  const size_t left = static_cast<size_t>(std::max(0, column - reach)),
               right = static_cast<size_t>(std::min(columns_, column + reach + 1)),
               top = static_cast<size_t>(std::max(0, row - reach)),
               bottom = static_cast<size_t>(std::min(rows_, row + reach + 1)),
               stride = static_cast<size_t>(columns_) + 1;
  return sums_[bottom * stride + right] - sums_[top * stride + right] - sums_[bottom * stride + left] +
         sums_[top * stride + left];
}

CellRegion grown(const CellRegion& region, const PlaneGrid& grid, int reach) {
  const SquareSums sums(grid, region);
  CellRegion out(region.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column)
      out[grid.index(column, row)] = sums.around(column, row, reach) > 0;
  }
  return out;
}

CellRegion closed(const CellRegion& region, const PlaneGrid& grid, int reach) {
  const SquareSums sums(grid, grown(region, grid, reach));
  const double all = (2 * reach + 1) * (2 * reach + 1);  // a square that the grid cuts is not closed
  CellRegion out = region;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (sums.around(column, row, reach) == all) out[grid.index(column, row)] = 1;
    }
  }
  return out;
}

CellRegion connected_to(const CellRegion& seeds, const CellRegion& region, const PlaneGrid& grid) {
  CellRegion out(region.size(), 0);
  std::vector<size_t> open;
  const auto reach = [&](size_t cell) {
    if (!region[cell] || out[cell]) return;
    out[cell] = 1;
    open.push_back(cell);
  };
  for (size_t i = 0; i < seeds.size(); ++i) {
    if (seeds[i]) reach(i);
  }
  while (!open.empty()) {
    const size_t cell = open.back();
    open.pop_back();
    visit_neighbours(grid, cell, reach);
  }
  return out;
}

CellRegion without_holes(const CellRegion& region, const PlaneGrid& grid) {
  CellRegion out = region;
  close_gaps(grid, CellRegion(grid.size(), 0), grid.size(), out);
  return out;
}

CellRegion rim_of(const CellRegion& region, const PlaneGrid& grid) {
  CellRegion out(region.size(), 0);
  for (size_t i = 0; i < region.size(); ++i) {
    if (!region[i]) continue;
    int inside = 0;
    visit_neighbours(grid, i, [&](size_t neighbour) { inside += region[neighbour] ? 1 : 0; });
    out[i] = inside < 4;
  }
  return out;
}

}  // namespace aligngs
