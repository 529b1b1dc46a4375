// The paper's depth loss L_d: 1 - Pearson correlation of rendered and prior depth (AlignGS, Gao et al. 2025).
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

/// Pixels: outside view.label_edge, loose depth validity, prior given. Zero without a prior, with fewer than
/// 5 % valid pixels, or when the prior or the rendering is (nearly) one frontal plane.
/// Needs compute_depth_map; returns 1 - rho, adds weight * dL / dz to workspace.depth_gradient.
template <class T>
double pearson_depth_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace);

}  // namespace aligngs
