// Training views that serve each other as neighbours in the multi-view terms (PGSR, Chen et al.
// 2024), and which of them a step takes.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/camera.h"

namespace aligngs {

/// The published rule. Its distances are world units of scenes of about unit size, so here they are shares of the
/// robust scene extent.
struct NeighbourRule {
  double angle_max = 30;       ///< between the optical axes, degrees, exclusive
  double distance_min = 0.01;  ///< between the centres / extent, exclusive: no parallax below
  double distance_max = 1.5;   ///< the same, exclusive
  size_t most = 8;             ///< the nearest so many are kept
};

/// Per camera the indices of its neighbours, nearest centre first, equal distances by index; possibly none.
/// extent > 0, scene units. Cameras whose pose is not finite are nobody's neighbours.
std::vector<std::vector<int>> choose_neighbours(const std::vector<Camera>& cameras, double extent,
                                                const NeighbourRule& rule = {});

/// One step's draw.
struct DrawnNeighbour {
  int view = -1;      ///< -1: there is none
  uint64_t seed = 0;  ///< for the random choices of the step's terms
};
/// A function of seed and iteration alone, so that a resumed run draws what the whole one drew.
DrawnNeighbour draw_neighbour(const std::vector<int>& neighbours, uint64_t run_seed, int64_t iteration);

}  // namespace aligngs
