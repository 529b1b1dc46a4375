// Kernel of step_outcome.h.
#include "engine/cuda/step_outcome.h"

#include <cmath>
#include <iterator>

#include "device/device_language.h"
#include "device/launch.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/engine_arrays.h"

namespace aligngs::cuda {

__global__ void judge_step_kernel(StepOutcomeInputs in, DeviceSpan<StepOutcome> out) {
  if (threadIdx.x != 0) return;
  StepOutcome o{};
  o.terms = in.terms[0];
  if (!in.semantic_terms.empty()) {
    o.terms.add(Loss::kSemanticSoft, in.soft_weight, in.semantic_terms[kSoftTerm]);
    o.terms.add(Loss::kSemanticHard, in.hard_weight, in.semantic_terms[kHardTerm]);
  }
  for (int k = 0; k < kGradientSquares; ++k) o.squares[k] = in.squares[k];
  o.bad = in.bad[0];
  if (!in.neighbour_bad.empty() && in.neighbour_bad[0] < o.bad) o.bad = in.neighbour_bad[0];
  o.visible = in.visible[0];
  // Without its factor a loss of weight 0 would not show in the total, but such a term is not computed. The sum of what
  // is finite can still overflow, so the total is looked at as well.
  double all = 0;
  for (size_t k = 0; k < kLosses; ++k) all += o.terms.values.values[k];
  const bool finite = all - all == 0 && o.terms.total - o.terms.total == 0;
  o.blocked = o.bad != kNoBadGradient || !finite ? 1 : 0;
  out[0] = o;
}
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
  return {std::sqrt(outcome.squares[kPhotometricSquares] / rows), std::sqrt(outcome.squares[kCouplingSquares] / rows)};
}

NonFinite symptom_of(const StepOutcome& outcome) {
  if (const char* term = non_finite_loss(outcome.terms)) return {true, -1, term};
  if (outcome.bad == kNoBadGradient) return {};
  const size_t index = static_cast<size_t>(outcome.bad % 8);
  return {true, static_cast<int64_t>(outcome.bad / 8),
          index < std::size(kClassNames) ? kClassNames[index] : "gradient"};
}

}  // namespace aligngs::cuda
