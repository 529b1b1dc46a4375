// Colours of the places of a plane that nobody saw: smooth between those that somebody saw.
#pragma once

#include <vector>

#include "core/vec.h"
#include "edit/fill/plane_grid.h"

namespace aligngs {

/// Covariance of what a colour covers, cells squared. All 0: its own cell alone.
struct CellSpread {
  double xx = 0, xy = 0, yy = 0;
};

/// One known colour: a place in cells of a grid, and how much it counts.
struct KnownColor {
  Vec2d place;
  Vec3f color;  ///< any linear coding, e.g. the constant spherical harmonic
  float weight = 1;
  CellSpread spread = {};
};

/// A colour for each cell of the grid: near known colours their mean, elsewhere a smooth surface through them. It is a
/// pull-push pyramid (Gortler et al. 1996) with sweeps of relaxation on every level. No known colour draws a
/// streak, as the nearest one would. Empty when nothing is known.
std::vector<Vec3f> continued_colors(const PlaneGrid& grid, const std::vector<KnownColor>& known);

}  // namespace aligngs
