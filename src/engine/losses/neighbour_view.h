// The other view of the multi-view terms (multi_view_geometric.h, multi_view_photometric.h).
#pragma once

#include <cstdint>

#include "engine/losses/workspace.h"
#include "engine/training_view.h"

namespace aligngs {

/// Constants of a step: no gradient reaches them. PGSR renders the neighbour's depth with gradients, too. Here another
/// step exchanges the roles and trains the neighbour, which halves the cost of this one.
template <class T>
struct NeighbourView {
  const TrainingView& view;  ///< its camera and photo
  const T* depth = nullptr;  ///< [H * W] of its camera, rendered plane depth, 0 = none
  uint64_t seed = 0;         ///< draws the pixels of the photometric term
};

template <class T>
struct MapLossInputs;

/// Computes the plane depth of rendered maps as map_losses does, and keeps the kDepthTight part in
/// workspace.neighbour_depth. Later calls of map_losses with this workspace do not change it. `inputs` are the maps of
/// the neighbour and its view; its mask counts.
template <class T>
void keep_neighbour_depth(const MapLossInputs<T>& inputs, MapLossWorkspace<T>& workspace);

}  // namespace aligngs
