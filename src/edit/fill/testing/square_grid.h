// A square grid on the plane z = 0, for tests of what lies on a surface.
#pragma once

#include "edit/fill/plane_grid.h"

namespace aligngs {

/// `cells` x `cells` cells with the edge `cell`, scene units; u is x, v is y and the normal z.
inline PlaneGrid square_grid(int cells, double cell) {
  PlaneGrid grid;
  grid.u = {1, 0, 0};
  grid.v = {0, 1, 0};
  grid.normal = {0, 0, 1};
  grid.cell = cell;
  grid.columns = grid.rows = cells;
  return grid;
}

}  // namespace aligngs
