// Multi-scale deformable attention (Zhu et al. 2021): each query looks at a few places per level.
#pragma once

#include <string>
#include <vector>

#include "nn/ops/linear.h"
#include "nn/tensor.h"

namespace aligngs::nn {

struct MapSize {
  int64_t height = 0, width = 0;
  int64_t places() const { return height * width; }
};

class DeformableAttention {
 public:
  DeformableAttention() = default;
  /// value_proj, sampling_offsets, attention_weights, output_proj below `weights`. Sizes follow
  /// from the tensors, given levels, and heads where they are not 0 (otherwise 4 points per level).
  DeformableAttention(const Compute& compute, const Weights& weights, int64_t levels, int64_t heads = 0);

  int64_t heads() const { return heads_; }

  /// query [queries, channels]; reference [queries, 2 or 2 * levels] in units of the map; value:
  /// the levels one after the other, [sum of places, channels]. Places outside a map count as zero.
  Matrix operator()(Compute& compute, const Matrix& query, const Matrix& reference, const Matrix& value,
                    const std::vector<MapSize>& levels) const;

 private:
  int64_t levels_ = 0, heads_ = 0, points_ = 0;
  Linear value_, offsets_, weights_, output_;
};

}  // namespace aligngs::nn
