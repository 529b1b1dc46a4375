// torch.nn.MultiheadAttention at inference.
#pragma once

#include <vector>

#include "nn/ops/linear.h"

namespace aligngs::nn {

class MultiheadAttention {
 public:
  MultiheadAttention() = default;
  /// in_proj_weight [3 C, C] (queries, keys, values), in_proj_bias, out_proj.{weight, bias}.
  MultiheadAttention(const Compute& compute, const Weights& weights, int64_t channels, int64_t heads);
  /// masks: 0 none, 1 for all heads, or one per head; masked [masks, queries, keys], not zero where
  /// a query does not look.
  Matrix operator()(Compute& compute, const Matrix& query, const Matrix& key, const Matrix& value, int64_t masks = 0,
                    const uint8_t* masked = nullptr) const;

 private:
  int64_t heads_ = 1;
  Linear query_, key_, value_, out_;
};

}  // namespace aligngs::nn
