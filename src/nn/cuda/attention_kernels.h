// Softmax attention that never forms the matrix of scores (Milakov and Gimelshein 2018; Dao et al. 2022).
#pragma once

#include "device/device_memory.h"
#include "nn/network_device.h"

namespace aligngs::cuda {

constexpr int64_t kMostHeadDim = 256;        ///< of float32 attention: what the lanes of a warp keep
constexpr int64_t kMostTensorHeadDim = 128;  ///< of attention on tensor cores: sums in registers

struct AttentionSpans {
  nn::AttentionShape shape;
  /// rows [sequences * queries or keys], all heads of a row together
  DeviceSpan<const float> queries, keys, values;
  int64_t query_stride = 0, key_stride = 0, value_stride = 0;
  DeviceSpan<const uint8_t> masked;  ///< [sequences, masks, queries, keys] or empty
  DeviceSpan<float> out;             ///< [sequences * queries, heads * head_dim]
};

/// Operands rounded to bfloat16, sums in float32; head_dim at most kMostTensorHeadDim, no mask.
void attention_bf16(const DeviceContext& context, const AttentionSpans& spans);
/// In float32; head_dim at most kMostHeadDim.
void attention_float(const DeviceContext& context, const AttentionSpans& spans);

}  // namespace aligngs::cuda
