// Operations on padded semantic rows of the Gaussians in view.
#pragma once

#include <cstddef>

namespace aligngs::cpu {

/// out[0..padded) = softmax(logits[0..channels)), zero-padded.
void softmax_row(const float* logits, size_t channels, size_t padded, float* out);
/// out[0..padded) = in[0..channels), zero-padded.
void copy_row(const float* in, size_t channels, size_t padded, float* out);
/// out += in, both padded and aligned.
void add_row(const float* in, size_t padded, float* out);

}  // namespace aligngs::cpu
