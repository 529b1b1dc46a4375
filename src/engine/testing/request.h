// The step that most tests of the engines ask for: losses on colour and classes with weights as in the paper.
// Blend and coupling are our own.
#pragma once

#include "engine/settings.h"

namespace aligngs {

inline LossSettings color_and_class_losses() {
  LossSettings losses;
  losses.weight[Loss::kL1] = 0.8f;
  losses.weight[Loss::kSsim] = 0.2f;
  losses.weight[Loss::kFlatten] = 100;
  losses.weight[Loss::kSemanticSoft] = 1;
  losses.weight[Loss::kSemanticHard] = 0.1f;
  losses.semantic_blend = SemanticBlend::kProbabilities;
  losses.coupling = SemanticCoupling::kBounded;
  losses.coupling_strength = 0.1f;
  losses.log_depth_huber = 0.02f;
  return losses;
}

inline StepRequest color_and_class_request() {
  StepRequest request;
  request.losses = color_and_class_losses();
  request.adam.skip_invisible_semantics = true;
  return request;
}

}  // namespace aligngs
