// Operations on padded semantic rows of the Gaussians in view.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aligngs::cpu {

/// out[0..padded) = softmax(logits[0..channels)), zero-padded, with `last_shift` added to the last logit: the logarithm
/// of the number of classes that it represents.
void softmax_row(const float* logits, size_t channels, size_t padded, float last_shift, float* out);
/// out[0..padded) = in[0..channels), zero-padded.
void copy_row(const float* in, size_t channels, size_t padded, float* out);
/// out[0..depth) = in[0..padded) - shift in bfloat16, rounded to nearest, ties to even; zero-padded, as are the numbers
/// from `channels` on. Not a number stays not a number.
void round_row(const float* in, size_t channels, size_t padded, size_t depth, float shift, uint16_t* out);
/// Operands of the products on AMX tiles from a row of logits: its softmax, or with `probabilities` false the logits
/// less their mean. round_row writes them to out[0..depth). `scratch` is [padded].
void round_features(const float* logits, size_t channels, size_t padded, size_t depth, bool probabilities,
                    float last_shift, float* scratch, uint16_t* out);
/// Mean of a padded row's first `channels` numbers.
float row_mean(const float* in, size_t channels, size_t padded);
/// out = in, both padded and aligned, past the caches. To be completed by finish_streams() on the same thread.
void stream_row(const float* in, size_t padded, float* out);
void finish_streams();
/// Asks for a row that is read soon: the processor does not foresee rows with gaps between them.
inline void prefetch_row(const float* row, size_t channels) {
  constexpr size_t kLineFloats = 16;
  for (size_t c = 0; c < channels; c += kLineFloats) __builtin_prefetch(row + c);
}
/// out += in, both padded and aligned.
void add_row(const float* in, size_t padded, float* out);

}  // namespace aligngs::cpu
