// The paper's depth loss L_d: 1 - Pearson correlation of rendered and prior depth (aligngs.md 4.4).
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

inline constexpr double kPearsonMinimumShare = 0.05;    ///< of the pixels must be valid (guidance 2.2)
inline constexpr double kPearsonMinimumSpread = 0.05;   ///< standard deviation / mean of the prior (guidance 2.2)
inline constexpr double kPearsonRenderedSpread = 0.01;  ///< of the rendered depth: the gradient grows as 1 / spread
inline constexpr double kPearsonEpsilon = 1e-6;         ///< added to both standard deviations, as released

/// Pixels: outside view.label_edge, loose depth validity, prior given. Zero without a prior, with fewer than
/// 5 % valid pixels, or when the prior or the rendering is (nearly) one frontal plane.
/// Needs compute_depth_map; returns 1 - rho, adds weight * dL / dz to workspace.depth_gradient.
template <class T>
double pearson_depth_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace);

}  // namespace aligngs
