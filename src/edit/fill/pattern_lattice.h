// The lattice of a pattern: the two shifts that lay it on itself, and its mean over all of its copies.
#pragma once

#include <optional>
#include <vector>

#include "edit/fill/texture_map.h"

namespace aligngs {

struct LatticeSettings {
  int reach = 90;              ///< cells: longest shift that is looked at
  double shortest = 10;        ///< cells: shorter shifts resemble because the map is smooth
  float least_peak = 0.2f;     ///< correlation at the end of a basis vector
  float least_mean = 0.28f;    ///< mean correlation over all shifts of the lattice
  double least_overlap = 0.2;  ///< share of the known cells that lie on known cells after a shift
};

/// Shifts by whole multiples of both vectors lay a pattern on itself.
struct PatternLattice {
  Vec2d first, second;  ///< cells
  float likeness = 0;   ///< mean correlation of the pattern with itself over the lattice
};

/// The lattice at which a map resembles itself most. Its pairs of shifts are peaks of the correlation. Their lattice has
/// the largest sum of correlations over the root of their number. A lattice that is too fine meets places of no likeness.
/// One that is too coarse leaves some out. It is empty without one.
std::optional<PatternLattice> pattern_lattice(const TextureMap& map, const LatticeSettings& settings = {});

/// Mean of the known copies of each cell, without itself; 0 where none is known.
std::vector<Vec3f> mean_of_copies(const TextureMap& map, const PatternLattice& lattice);

}  // namespace aligngs
