// Adam over every parameter class of the model, and the limits on shape.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/parameter_gradients.h"
#include "engine/engine_arrays.h"
#include "engine/settings.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::cpu {

/// The semantic gradients of a step; null pointers when it had none.
struct SemanticGradients {
  const uint32_t* rank = nullptr;    ///< [N] row in the arrays below of a Gaussian in view
  const uint8_t* written = nullptr;  ///< [visible]
  const float* gradients = nullptr;  ///< [visible][padded] dL/dfeatures
  bool probabilities = false;        ///< features are pi = softmax(s), else s
  const float* softmax = nullptr;    ///< [visible][padded] pi; nullptr: to be taken from `rounded`, or computed again
  float last_shift = 0;              ///< of that softmax (semantic_rows.h)
  /// [N][padded_depth(padded)] features in bfloat16 as round_features writes them, or nullptr. They are what the
  /// gradient was taken at; rows that change are rounded again, while they are in the cache.
  uint16_t* rounded = nullptr;
};

/// Updates model and moments, then applies request.limits. All gradients must be within kGradientLimit.
void optimise(const StepRequest& request, const ParameterGradients& gradients, const SemanticGradients& semantics,
              const ProjectedView& view, ThreadPool& pool, GaussianModel& model, AdamMoments& moments);

}  // namespace aligngs::cpu
