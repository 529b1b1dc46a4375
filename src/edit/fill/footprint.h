// Places of the floor under a removed object.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/plane_grid.h"

namespace aligngs {

struct Footprint {
  PlaneGrid grid;
  std::vector<uint8_t> cells;  ///< 1 under the object; empty without one

  /// The object is above the projection of a place on the plane.
  bool holds(const Vec3d& place) const;
};

/// The footprint of some rows of a model on a plane; cells have the edge `cell`, scene units. A cell is under the object
/// where the rows have an accumulated opacity of `least`. So is one that such cells enclose: nobody saw the underside
/// of a chest.
Footprint footprint_of(const GaussianModel& model, const std::vector<uint32_t>& rows, const PlaneOf& plane, double cell,
                       float least);

}  // namespace aligngs
