// Exponentials of whole ranges of rows.
#pragma once

#include <cstddef>

namespace aligngs::cpu {

/// out[i] = exp(logs[i]) within 2 ulp; infinity beyond 88 and 1.6e-38 below -87. Not for NaN.
void exp_range(const float* logs, size_t count, float* out);
/// out[i] = 1 / (1 + exp(-logits[i])). Not for NaN.
void sigmoid_range(const float* logits, size_t count, float* out);

}  // namespace aligngs::cpu
