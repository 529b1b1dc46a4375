// The closed-form start of a semantic row from what the teachers say where the Gaussian is seen.
#pragma once

#include <cmath>

#include "core/host_device.h"

namespace aligngs {

/// epsilon inside the logarithm for a row that saw the teacher with weights m in sum: kPseudoCount + kShare m. The
/// first, in pixels per class, keeps a row that hardly any pixel saw near uniform. The second keeps absent classes just
/// above the floor of the loss (semantic_floor). Below the floor training could not change the row's class.
inline constexpr float kPseudoCount = 0.01f, kShare = 2e-3f;

/// row_c = log(sums_c / count_c + epsilon) minus the mean over all classes, with sums_c = sum over pixels of w t_c. The
/// last channel represents `remainder` classes of equal probability (engine/shared/active_classes.h); 0: it is one class.
ALIGNGS_HD inline void semantic_start(const float* sums, int channels, int remainder, float* row) {
  using std::log;
  double mass = 0, mean = 0, classes = 0;
  for (int c = 0; c < channels; ++c) mass += static_cast<double>(sums[c]);
  const float epsilon = kPseudoCount + kShare * static_cast<float>(mass);
  for (int c = 0; c < channels; ++c) {
    const float count = c + 1 == channels && remainder > 0 ? static_cast<float>(remainder) : 1.0f;
    row[c] = log(sums[c] * (1.0f / count) + epsilon);
    mean += static_cast<double>(count * row[c]);
    classes += static_cast<double>(count);
  }
  for (int c = 0; c < channels; ++c) row[c] -= static_cast<float>(mean / classes);
}

}  // namespace aligngs
