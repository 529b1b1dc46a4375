// Operations on rows of floats in vector code, for one thread.
#pragma once

#include <cstdint>

namespace aligngs::nn {

enum class Activation { kNone, kRelu, kGelu, kSilu };

/// Rounds to bfloat16, to nearest even; relu: negative values become 0 first.
void round_to_bfloat16(const float* x, int64_t count, bool relu, uint16_t* out);
/// out = max(x, 0).
void relu_copy(const float* x, int64_t count, float* out);

/// y[r, c] = activation(y[r, c] + bias[c]); bias may be null. GELU is the exact erf form.
void add_bias_and_activate(float* y, int64_t rows, int64_t columns, const float* bias, Activation activation);

/// out[r, c] = silu(x[r, c]) * x[r, columns + c], x of 2 * columns per row.
void swiglu(const float* x, int64_t rows, int64_t columns, float* out);

/// x[r, c] += scale[c] * (y[r, c] + bias[c]); scale and bias may be null.
void add_scaled(float* x, const float* y, int64_t rows, int64_t columns, const float* bias, const float* scale);

/// Biased variance; weight and bias may be null (then 1 and 0). y may be x.
void layer_norm(const float* x, int64_t rows, int64_t columns, const float* weight, const float* bias, float eps,
                float* y);

/// Softmax along the columns, in place.
void softmax_rows(float* x, int64_t rows, int64_t columns);

}  // namespace aligngs::nn
