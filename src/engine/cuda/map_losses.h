// Every loss that is a function of the rendered maps of one view, values and gradients. It has the terms and degenerate
// cases of its twin engine/losses/map_losses.h.
#pragma once

#include "engine/cuda/multi_view.h"
#include "engine/cuda/training_maps.h"
#include "engine/cuda/view_spans.h"
#include "engine/loss_terms.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct MapLossSpans {
  RenderMapSpans maps;
  TrainingMapSpans view;
  LossSettings settings;
  NeighbourSpans neighbour{};  ///< empty: no multi-view term, whatever its weight
};

struct MapLossOutputs {
  /// color: written. normal, distance: written where the settings have geometry terms, else untouched. alpha:
  /// untouched, because no loss of the maps has a gradient for it.
  MapGradientSpans gradients;
  DeviceSpan<float> residual;   ///< [H W] written: mean absolute colour difference, 0 under the mask; empty: not wanted
  DeviceSpan<LossTerms> terms;  ///< [1] written, those of other losses as 0
};

/// Scratch comes from the arena: map_loss_scratch_bytes.
void map_losses(DeviceArena& arena, const MapLossSpans& in, const MapLossOutputs& out);

/// With a neighbour of as many pixels, where the multi-view terms have a weight.
uint64_t map_loss_scratch_bytes(const LossSettings& settings, size_t pixels);

}  // namespace aligngs::cuda
