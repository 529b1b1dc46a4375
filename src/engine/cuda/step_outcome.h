// The outcome of a step, in one place on the device: the host waits for it alone.
#pragma once

#include "device/device_memory.h"
#include "engine/engine.h"
#include "engine/formulas/semantic_loss.h"
#include "engine/loss_terms.h"
#include "engine/settings.h"

namespace aligngs::cuda {

struct StepOutcome {
  LossTerms terms;
  double squares[2];       ///< ParameterGradientOutputs::squares
  unsigned long long bad;  ///< bad_gradient_key, or kNoBadGradient; 0 also where the pairs did not fit
  uint32_t visible;        ///< touched rows
  uint32_t blocked;        ///< 1: something is not finite, the optimiser must write nothing
};

struct StepOutcomeInputs {
  DeviceSpan<const LossTerms> terms;         ///< [1] of map_losses and add_shape_terms
  DeviceSpan<const double> semantic_terms;   ///< [2] of semantic_visit; empty: none
  DeviceSpan<const double> squares;          ///< [2]
  DeviceSpan<const unsigned long long> bad;  ///< [1]
  DeviceSpan<const uint32_t> visible;        ///< [1]
  float soft_weight = 0, hard_weight = 0;    ///< LossSettings
  /// [1] of the neighbour's projection and lists; empty: no neighbour
  DeviceSpan<const unsigned long long> neighbour_bad{};
};

/// StepOutcome::blocked of out[0], for the kernels that must not write after a failure.
DeviceSpan<const uint32_t> blocked_of(DeviceSpan<StepOutcome> out);

/// Puts the parts together, total included, and decides whether the optimiser may write. The optimiser and the density
/// statistics read `blocked` on the device, so nothing waits for the host in between.
void judge_step(const DeviceContext& context, const StepOutcomeInputs& in, DeviceSpan<StepOutcome> out);

/// Root mean squares over the visible rows, as update_coupling_balance wants them; 0 where none is visible.
struct GradientScale {
  double photometric_rms = 0, coupling_rms = 0;
};
GradientScale gradient_scale(const StepOutcome& outcome);

/// The place where the step failed: the first loss, else the first gradient. To be refined by find_bad_parameter.
NonFinite symptom_of(const StepOutcome& outcome);

}  // namespace aligngs::cuda
