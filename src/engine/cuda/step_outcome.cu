#include "engine/cuda/step_outcome.h"

#include <cmath>
#include <iterator>
#include <utility>

#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/runtime/launch.h"

namespace aligngs::cuda {
namespace {

/// The losses in the order in which they are named when one is not finite.
constexpr std::pair<const char*, double LossTerms::*> kTerms[] = {
    {"l1", &LossTerms::l1},
    {"ssim", &LossTerms::ssim},
    {"flatten", &LossTerms::flatten},
    {"semantic_soft", &LossTerms::semantic_soft},
    {"semantic_hard", &LossTerms::semantic_hard},
    {"pearson", &LossTerms::pearson},
    {"log_depth", &LossTerms::log_depth},
    {"normal_consistency", &LossTerms::normal_consistency},
    {"normal_boundary", &LossTerms::normal_boundary},
    {"crease", &LossTerms::crease},
    {"prior_normal", &LossTerms::prior_normal},
    {"opacity_l1", &LossTerms::opacity_l1},
    {"scale_l1", &LossTerms::scale_l1},
    {"total", &LossTerms::total}};

constexpr const char* kClassNames[] = {"positions", "log_scales", "rotations", "opacity_logits", "sh", "semantics"};

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
  o.visible = in.visible[0];
  // Without its factor a loss of weight 0 would not show in the total, but such a term is not computed. The sum of what
  // is finite can still overflow, so the total is looked at as well.
  const LossTerms& t = o.terms;
  const double all = t.l1 + t.ssim + t.flatten + t.semantic_soft + t.semantic_hard + t.pearson + t.log_depth +
                     t.normal_consistency + t.normal_boundary + t.crease + t.prior_normal + t.opacity_l1 + t.scale_l1;
  const bool finite = all - all == 0 && t.total - t.total == 0;
  o.blocked = o.bad != kNoBadGradient || !finite ? 1 : 0;
  out[0] = o;
}

}  // namespace

DeviceSpan<const uint32_t> blocked_of(DeviceSpan<StepOutcome> out) { return {&out.data->blocked, 1}; }

void judge_step(const DeviceContext& context, const StepOutcomeInputs& in, DeviceSpan<StepOutcome> out) {
  launch(context, "judge_step", judge_step_kernel, {dim3(1), dim3(32), 0}, in, out);
}

const char* bad_loss(const LossTerms& terms) {
  for (const auto& [name, term] : kTerms) {
    if (!std::isfinite(terms.*term)) return name;
  }
  return nullptr;
}

GradientScale gradient_scale(const StepOutcome& outcome) {
  if (outcome.visible == 0) return {};
  const double rows = outcome.visible;
  return {std::sqrt(outcome.squares[0] / rows), std::sqrt(outcome.squares[1] / rows)};
}

NonFinite symptom_of(const StepOutcome& outcome) {
  if (const char* term = bad_loss(outcome.terms)) return {true, -1, term};
  if (outcome.bad == kNoBadGradient) return {};
  const size_t index = static_cast<size_t>(outcome.bad % 8);
  return {true, static_cast<int64_t>(outcome.bad / 8),
          index < std::size(kClassNames) ? kClassNames[index] : "gradient"};
}

}  // namespace aligngs::cuda
