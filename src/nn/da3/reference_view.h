// The view of a scene that Depth Anything 3 takes as its reference (Lin et al. 2025; published rule "saddle_balanced").
#pragma once

#include <cstdint>
#include <vector>

#include "nn/tensor.h"

namespace aligngs::nn {

enum class Da3ReferenceRule {
  kSaddleBalanced,  ///< the view that is least extreme by similarity, length and variance of its class token
  kFirst,
  kMiddle  ///< advised for video
};

struct Da3Reference {
  int64_t view = 0;
  std::vector<float> scores;  ///< per view, smallest wins; empty unless the rule is kSaddleBalanced
};

/// class_tokens [views, channels]; at least one view. The first of equal scores wins.
Da3Reference choose_reference_view(const Matrix& class_tokens, Da3ReferenceRule rule);

}  // namespace aligngs::nn
