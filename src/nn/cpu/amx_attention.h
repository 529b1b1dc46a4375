// Attention of one head on the matrix unit of x86 processors (AMX, bfloat16), with AVX-512 for the
// softmax.
#pragma once

#include <cstdint>

#include "nn/compute.h"

namespace aligngs::nn {

inline constexpr int64_t kAmxHeadDim = 64;  ///< smaller heads are padded with zeros
inline constexpr int64_t kAmxQueries = 32;  ///< queries are padded to a multiple
inline constexpr int64_t kAmxKeys = 32;     ///< keys are padded to a multiple

/// All operands are bfloat16 bits, finite, padding included. Only with matrix_tiles_available().
struct AmxAttentionBlock {
  const uint16_t* queries;  ///< [queries/16][32 pairs of dimensions][16][2], scaled by log2(e)
  const uint16_t* keys;     ///< [keys][64]
  const uint16_t* values;   ///< [keys/32][64][32]
  int64_t query_count, key_count;
  int64_t head_dim;  ///< values of `out` per query, at most 64
  float* out;        ///< [queries][head_dim], rows out_stride apart
  int64_t out_stride;
};
void amx_attention(const AmxAttentionBlock& block, Scratch& scratch);

}  // namespace aligngs::nn
