// Multi-view photometric consistency: the photo around a pixel must look like a neighbouring photo across the plane that the
// pixel shows (PGSR, Chen et al. 2024; facts in aligngs.md 4.8).
#pragma once

#include "engine/losses/multi_view_geometric.h"

namespace aligngs {

/// Patches of one step: the published 102400 of a view of 640 x 480, and the same share of a smaller one.
inline constexpr double kPatchesMax = 102400;
inline constexpr double kPatchShare = kPatchesMax / (640.0 * 480.0);

/// Mean of w (1 - NCC^2) over the patches that are used (formulas/patch_score.h), w from the agreement and constant; the
/// gradient reaches the blended normal and distance of the patch's centre. Each pixel that agrees is drawn by itself with
/// the probability that makes kPatchShare of the pixels expected, from inputs.neighbour->seed. Zero with fewer than 1 % of
/// the pixels in agreement, and where no patch is used.
/// Needs compare_with_neighbour.
template <class T>
double multi_view_photometric_loss(const MapLossInputs<T>& inputs, double weight, const ViewAgreement& agreement,
                                   MapLossWorkspace<T>& workspace, MapGradients<T>& gradients);

/// True for `share` of all pixels in the mean; the same for the same seed and pixel on every machine.
bool draws_patch(uint64_t seed, size_t pixel, double share);

}  // namespace aligngs
