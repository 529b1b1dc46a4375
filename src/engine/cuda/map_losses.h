// Every loss that is a function of the rendered maps of one view, values and gradients; the twin of
// engine/losses/map_losses.h, whose terms and degenerate cases it has.
#pragma once

#include "engine/cuda/training_maps.h"
#include "engine/cuda/view_spans.h"
#include "engine/loss_terms.h"
#include "engine/settings.h"

namespace aligngs::cuda {

/// Some loss looks at normal, distance or alpha.
bool has_geometry_terms(const LossSettings& settings);

struct MapLossInputs {
  RenderMapSpans maps;
  TrainingMapSpans view;
  LossSettings settings;
};

struct MapLossOutputs {
  /// color: written. normal, distance: written where has_geometry_terms, else untouched. alpha: untouched, because no
  /// loss of the maps has a gradient for it.
  MapGradientSpans gradients;
  DeviceSpan<float> residual;   ///< [H W] written: mean absolute colour difference, 0 under the mask; empty: not wanted
  DeviceSpan<LossTerms> terms;  ///< [1] written, those of other losses as 0
};

/// Scratch comes from the arena: map_loss_scratch_bytes.
void map_losses(DeviceArena& arena, const MapLossInputs& in, const MapLossOutputs& out);

uint64_t map_loss_scratch_bytes(const LossSettings& settings, size_t pixels);

}  // namespace aligngs::cuda
