// L_ng: the blended normals and the normals of the depth map must agree (AlignGS, Gao et al. 2025; PGSR, Chen et al.
// 2024).
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

/// Mean over valid pixels of 1 - n . n_depth with both normals unit; the gradient reaches both. Valid: the
/// pixel has a blended direction and a depth normal (depth_stencil of formulas/normal_terms.h; settings.paper_normals
/// chooses its form).
/// Zero with fewer than 1 % valid pixels.
/// Needs compute_depth_map and compute_unit_normals; adds weight * dL / dz to workspace.depth_gradient.
template <class T>
double normal_consistency_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace,
                               MapGradients<T>& gradients);

}  // namespace aligngs
