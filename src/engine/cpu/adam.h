// The optimiser step on flat arrays; formula of engine/formulas/adam.h.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/formulas/adam.h"
#include "engine/shared/optimiser_settings.h"

namespace aligngs::cpu {

/// True when |values| <= limit throughout (false with a NaN).
bool all_within(const float* values, size_t count, float limit);

/// parameters, m and v [count] by one step with one rate.
void adam_range(const AdamStep<float>& step, const float* gradients, size_t count, float* parameters, float* m,
                float* v);

/// Rows of spherical harmonics [rows][48]: the first 3 numbers have their own rate. `touched`[row] == 0: the gradient
/// is zero and not read. Only the first `used` numbers of a row are visited: the others have neither gradient nor
/// moments.
struct ShAdam {
  AdamStep<float> dc, rest;
  size_t used = 48;  ///< rounded up to a multiple of 16 inside
};
void adam_sh_rows(const ShAdam& steps, const float* gradients, const unsigned char* touched, size_t rows,
                  float* parameters, float* m, float* v);

/// One semantic row of `channels` numbers. With `softmax` (the row's probabilities, padded) `gradient` is dL/dpi and
/// goes through the softmax first; without, it is dL/ds. gradient == nullptr: zero.
void adam_semantic_row(const AdamStep<float>& step, const float* gradient, const float* softmax, size_t channels,
                       float* parameters, float* m, float* v);
/// The same with probabilities in bfloat16, padded too.
void adam_semantic_row(const AdamStep<float>& step, const float* gradient, const uint16_t* softmax, size_t channels,
                       float* parameters, float* m, float* v);

}  // namespace aligngs::cpu
