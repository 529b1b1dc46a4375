// Small gaps in what a fill covers: cells that no rule marks and that show the black behind the room.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/plane_grid.h"

namespace aligngs {

/// Adds to `hole` the cells without a surface that the hole and the `closed` cells enclose. Closed are cells that have a
/// surface or must stay as they are, such as windows. Only gaps beside the hole are added, each of at most `most_cells`
/// cells: a larger one is not the fill's.
void close_gaps(const PlaneGrid& grid, const std::vector<uint8_t>& closed, size_t most_cells,
                std::vector<uint8_t>& hole);

}  // namespace aligngs
