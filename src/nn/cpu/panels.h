// Products of matrices in vectors of the processor: rows times panels of 16 columns.
#pragma once

#include <cstdint>

namespace aligngs::nn {

inline constexpr int64_t kPanel = 16;        ///< columns: one vector of AVX-512, two of AVX2, four of SSE
inline constexpr int64_t kJoinedPanels = 3;  ///< that are multiplied at once with AVX-512

/// c[r, p, :] = sum over k of a[r, k] b[p, k, :], for every row r and panel p.
struct PanelProduct {
  const float* a;    ///< [rows, depth]
  int64_t a_stride;  ///< floats from row to row
  int64_t rows, depth;
  const float* b;          ///< [panels][depth, 16]
  int64_t b_stride;        ///< floats from panel to panel
  int64_t panels;          ///< groups of kJoinedPanels are fastest with AVX-512
  float* c;                ///< [rows][panels][16], as the strides say
  int64_t c_stride;        ///< floats from row to row
  int64_t c_panel_stride;  ///< floats from panel to panel
  bool accumulate;         ///< c += a b instead of c = a b
};
void multiply_panels(const PanelProduct& product);

/// Numbers of 16 bits.
enum class HalfFormat { kBfloat16, kFloat16 };
/// out[i] = bits[i] as float32, exactly.
void widen(const uint16_t* bits, int64_t count, HalfFormat format, float* out);

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
