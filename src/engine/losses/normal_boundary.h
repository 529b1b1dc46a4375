// The paper's L_nb: normals on the two sides of a label edge are pushed apart (AlignGS, Gao et al. 2025).
#pragma once

#include "engine/formulas/normal_terms.h"
#include "engine/losses/map_losses.h"

namespace aligngs {

/// Mean of boundary_penalty over pairs of right and down neighbours with different teacher labels and blended
/// directions on both sides. Zero when there is no such pair. With settings.paper_normals off, pairs whose depths are
/// not tightly valid or jump by more than 5 % are left out (needs compute_depth_map then). Needs compute_unit_normals.
template <class T>
double normal_boundary_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace,
                            MapGradients<T>& gradients);

}  // namespace aligngs
