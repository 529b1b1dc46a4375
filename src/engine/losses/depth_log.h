// The default depth loss L_z: Huber norm of the log ratio of rendered and prior depth.
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

/// sum w h(log z - log(a p)) / sum w over pixels with tight depth validity and a prior p, w = view.depth_weight,
/// a = settings.prior_depth_scale. h(e) = e^2 / (2 delta) for |e| <= delta, else |e| - delta / 2, so its slope
/// is at most 1. Zero without a prior or with fewer than 1 % valid pixels.
/// Needs compute_depth_map; adds weight * dL / dz to workspace.depth_gradient.
template <class T>
double log_depth_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace);

}  // namespace aligngs
