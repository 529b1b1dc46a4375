// Neighbours of Gaussians, for whoever asks for those of the same places again.
#pragma once

#include <memory>
#include <vector>

#include "gaussians/point_tree.h"

namespace aligngs {

struct PlacedNeighbours {
  std::vector<float> positions;  ///< GaussianModel::positions
  std::shared_ptr<const NeighbourGraph> graph;

  /// Whether this is neighbour_graph() of these positions and `k`.
  bool serves(const std::vector<float>& of, size_t k) const { return graph && graph->k == k && positions == of; }
};

}  // namespace aligngs
