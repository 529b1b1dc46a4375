// The portable product of matrices: rows times panels of 16 columns.
#pragma once

#include <cstdint>

namespace aligngs::nn {

inline constexpr int64_t kPanel = 16;  ///< columns: one vector of AVX-512, two of AVX2, four of SSE

struct PanelProduct {
  const float* a;    ///< [rows, depth]
  int64_t a_stride;  ///< floats from row to row
  int64_t rows, depth;
  const float* b;    ///< [depth, 16]
  float* c;          ///< [rows, 16]
  int64_t c_stride;  ///< floats from row to row
  bool accumulate;   ///< c += a b instead of c = a b
};
void multiply_panel(const PanelProduct& product);

/// One step of the softmax of attention over `keys` rows of scores, 16 queries side by side. Scores
/// [keys, 16] (in units of log2) become weights 2^(score - most). The running maximum, the running
/// sum of weights and the sums [dimensions, 16] so far are brought to the new maximum.
struct SoftmaxStep {
  float* scores;
  int64_t keys;
  float* most;   ///< [16]
  float* total;  ///< [16]
  float* sums;
  int64_t dimensions;
};
void softmax_step(const SoftmaxStep& step);

}  // namespace aligngs::nn
