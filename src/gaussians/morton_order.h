// Rows in the order of a Morton curve (z-order) through their positions (Morton 1966; fast trainers of splats do it as
// well). Neighbours in space become neighbours in memory. The Gaussians of a tile, gathered by every pass over it, then
// share cache lines and pages. Everything that belongs to a row goes with it.
#pragma once

#include <cstdint>

#include "gaussians/density_control.h"

namespace aligngs {

/// Bits per axis of a Morton code. The cube has 2^21 cells a side. Even with a floater at a hundred times the room's
/// size, the room keeps over ten thousand cells a side.
inline constexpr int kMortonBits = 21;

/// Interleaves the lower kMortonBits bits of three cell numbers, x lowest.
uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z);

/// Puts the rows of a plan in the order of the Morton codes of their new positions in the cube around all of them.
/// Equal codes keep their order; positions that are not finite come last.
void sort_by_morton(const GaussianModel& model, RestructurePlan& plan);

/// The same for the rows of a model.
void sort_by_morton(GaussianModel& model);

}  // namespace aligngs
