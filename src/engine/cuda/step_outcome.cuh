// Kernel of step_outcome.h.
#pragma once

#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/runtime/device_language.h"
#include "engine/cuda/step_outcome.h"

namespace aligngs::cuda {

__global__ void judge_step_kernel(StepOutcomeInputs in, DeviceSpan<StepOutcome> out) {
  if (threadIdx.x != 0) return;
  StepOutcome o{};
  o.terms = in.terms[0];
  if (!in.semantic_terms.empty()) {
    o.terms.semantic_soft = in.semantic_terms[0];
    o.terms.semantic_hard = in.semantic_terms[1];
    o.terms.total += in.soft_weight * o.terms.semantic_soft + in.hard_weight * o.terms.semantic_hard;
  }
  o.squares[0] = in.squares[0];
  o.squares[1] = in.squares[1];
  o.bad = in.bad[0];
  if (!in.neighbour_bad.empty() && in.neighbour_bad[0] < o.bad) o.bad = in.neighbour_bad[0];
  o.visible = in.visible[0];
  // Without its factor a loss of weight 0 would not show in the total, but such a term is not computed. The sum of what
  // is finite can still overflow, so the total is looked at as well.
  const LossTerms& t = o.terms;
  const double all = t.l1 + t.ssim + t.flatten + t.semantic_soft + t.semantic_hard + t.pearson + t.log_depth +
                     t.normal_consistency + t.normal_boundary + t.crease + t.prior_normal + t.opacity_l1 + t.scale_l1 +
                     t.multi_view_geometric + t.multi_view_photometric;
  const bool finite = all - all == 0 && t.total - t.total == 0;
  o.blocked = o.bad != kNoBadGradient || !finite ? 1 : 0;
  out[0] = o;
}

}  // namespace aligngs::cuda
