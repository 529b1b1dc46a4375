#include "engine/cuda/step_outcome.h"

#include <cmath>
#include <iterator>

#include "device/launch.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/step_outcome.cuh"
#include "engine/engine_arrays.h"

namespace aligngs::cuda {
namespace {

constexpr const char* kClassNames[] = {"positions", "log_scales", "rotations", "opacity_logits", "sh", "semantics"};

}  // namespace

DeviceSpan<const uint32_t> blocked_of(DeviceSpan<StepOutcome> out) { return {&out.data->blocked, 1}; }

void judge_step(const DeviceContext& context, const StepOutcomeInputs& in, DeviceSpan<StepOutcome> out) {
  launch(context, "judge_step", judge_step_kernel, {dim3(1), dim3(32), 0}, in, out);
}

GradientScale gradient_scale(const StepOutcome& outcome) {
  if (outcome.visible == 0) return {};
  const double rows = outcome.visible;
  return {std::sqrt(outcome.squares[0] / rows), std::sqrt(outcome.squares[1] / rows)};
}

NonFinite symptom_of(const StepOutcome& outcome) {
  if (const char* term = non_finite_loss(outcome.terms)) return {true, -1, term};
  if (outcome.bad == kNoBadGradient) return {};
  const size_t index = static_cast<size_t>(outcome.bad % 8);
  return {true, static_cast<int64_t>(outcome.bad / 8),
          index < std::size(kClassNames) ? kClassNames[index] : "gradient"};
}

}  // namespace aligngs::cuda
