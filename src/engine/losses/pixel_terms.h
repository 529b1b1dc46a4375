// Every pixel term of the list (terms/pixel_terms.h) on the CPU, compiled for several instruction sets.
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

/// The function of one loss of the maps: its unweighted value. Adds `weight` times its gradient.
template <class T>
using PixelTermLoss = double (*)(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace,
                                 MapGradients<T>& gradients);

/// nullptr for a loss that is no pixel term. Needs compute_depth_map and compute_unit_normals, as the catalogue says.
/// Instantiated for float and double.
template <class T>
PixelTermLoss<T> pixel_term_loss(Loss loss);

}  // namespace aligngs
