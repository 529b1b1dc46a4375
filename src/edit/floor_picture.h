// The floor and what lies flat on it, seen from above.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "edit/fill/grid_regions.h"

namespace aligngs {

inline constexpr int kFloorLevels = 8;  ///< of each sRGB channel: colours within a level count as one
inline constexpr size_t kFloorColors = size_t(kFloorLevels) * kFloorLevels * kFloorLevels;

struct FloorPicture {
  PlaneGrid grid;
  CellRegion seen;                          ///< cells with a solid Gaussian there or close by
  std::array<std::vector<float>, 3> color;  ///< sRGB from 0 to 1, mean per cell; 0 where nothing is seen
  std::vector<uint16_t> shade;              ///< the levels of the three channels as one number below kFloorColors
};

/// Paints some Gaussians, each into the cell of its centre. Gaps of up to two cells get the mean of what is around.
/// `cell` is the edge of a cell, scene units. At least one row.
FloorPicture paint_floor(const GaussianModel& model, const std::vector<uint32_t>& rows, const PlaneOf& plane,
                         double cell);

}  // namespace aligngs
