// Adam over every parameter class of the model and the limits on shape, after formulas/adam.h and shape_terms.h.
#pragma once

#include "device/device_memory.h"
#include "engine/cuda/model_spans.h"
#include "engine/engine.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct OptimiserInputs {
  ModelSpans gradients;                        ///< of parameter_gradients and add_shape_terms
  DeviceSpan<const uint8_t> touched;           ///< [N] 0: the gradient of sh is zero and not read
  DeviceSpan<const float> semantic_gradients;  ///< [unculled rows][padded] dL/dlogits by rank; empty: none
  DeviceSpan<const uint8_t> semantic_written;  ///< [N]
  DeviceSpan<const uint32_t> rank;             ///< [N] TileListSpans::rank
  DeviceSpan<const uint32_t> blocked;          ///< [1] not 0: nothing is written; empty: never blocked
};

/// Parameters and their running moments, all three of one shape.
struct OptimiserState {
  ModelSpans model, m, v;
  DeviceSpan<float> semantic_updates;  ///< [N] of each semantic row so far; a step that writes the row adds one
};

/// One step. Only the first `sh_used` numbers of a row of sh, rounded up to four, are visited: the others must have
/// neither moments nor gradients. Settings must have passed check_optimiser_settings.
void optimise(const DeviceContext& context, const StepRequest& request, const OptimiserInputs& in,
              const OptimiserState& state, size_t sh_used);

/// Caps every opacity at `maximum` and clears its moments (Engine::reset_opacity); 0 < maximum < 1.
void cap_opacities(const DeviceContext& context, float maximum, const OptimiserState& state);

/// Engine::add_position_noise.
void add_position_noise(const DeviceContext& context, const PositionNoise& noise, const ModelSpans& model);

/// Engine::raise_scales; log_floors is [N].
void raise_scales(const DeviceContext& context, DeviceSpan<const float> log_floors, const ModelSpans& model);

/// The first row with a parameter that is not finite, by class in the order of the model; found == false: none. Waits
/// for the device.
NonFinite find_bad_parameter(DeviceArena& arena, const ModelSpans& model);

}  // namespace aligngs::cuda
