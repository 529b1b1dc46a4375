// Multi-view photometric consistency: the photo around a pixel must match a neighbouring photo across the pixel's plane
// (PGSR, Chen et al. 2024).
#pragma once

#include "engine/formulas/patch_draw.h"
#include "engine/losses/multi_view_geometric.h"

namespace aligngs {

/// Mean of w (1 - NCC^2) over the patches that are used (formulas/patch_score.h), w from the agreement and constant.
/// The gradient reaches the blended normal and distance of the patch's centre. Each pixel that agrees is drawn
/// independently, from inputs.neighbour->seed. The probability makes kPatchShare of the pixels expected. Zero with
/// fewer than 1 % of the pixels in agreement, and where no patch is used. Needs compare_with_neighbour.
template <class T>
double multi_view_photometric_loss(const MapLossInputs<T>& inputs, double weight, const ViewAgreement& agreement,
                                   MapLossWorkspace<T>& workspace, MapGradients<T>& gradients);

}  // namespace aligngs
