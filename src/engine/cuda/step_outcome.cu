#include "engine/cuda/step_outcome.h"

#include <cmath>
#include <iterator>
#include <utility>

#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/runtime/launch.h"
#include "engine/cuda/step_outcome.cuh"

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
