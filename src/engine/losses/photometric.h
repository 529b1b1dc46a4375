// The photometric losses: mean absolute colour difference and 1 - SSIM (3DGS, Kerbl et al. 2023).
#pragma once

#include "engine/formulas/photometric.h"
#include "engine/losses/map_losses.h"

namespace aligngs {

/// Adds l1, ssim (as 1 - SSIM), psnr and their part of total, and gradients to gradients.color. Pixels under the mask
/// (view.data.mask <= 0.5) have no loss and no gradient. They are left out of every mean, and the windows of SSIM see
/// the truth there. Nothing left: all terms zero.
template <class T>
void photometric_losses(const MapLossInputs<T>& inputs, MapLossWorkspace<T>& workspace, LossTerms& terms,
                        MapGradients<T>& gradients);

}  // namespace aligngs
