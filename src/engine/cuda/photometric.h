// Photometric losses: L1 and SSIM, values and gradients. The twin of losses/photometric.h.
#pragma once

#include "engine/cuda/map_losses.h"

namespace aligngs::cuda {

/// Writes gradients.color, the residual unless empty, and the terms, those of other losses as 0.
void photometric_losses(DeviceArena& arena, const MapLossSpans& in, const MapLossOutputs& out);

uint64_t photometric_scratch_bytes(const LossSettings& settings, size_t pixels);

}  // namespace aligngs::cuda
