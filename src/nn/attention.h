// Softmax attention that never forms the matrix of scores (blocked with a running maximum, as in
// Milakov and Gimelshein 2018, and Dao et al. 2022).
#pragma once

#include <cstdint>

#include "nn/compute.h"

namespace aligngs::nn {

struct AttentionShape {
  int64_t sequences = 1;  ///< independent of each other
  int64_t heads = 1;
  int64_t head_dim = 0;
  int64_t queries = 0;  ///< per sequence
  int64_t keys = 0;     ///< per sequence
  int64_t masks = 0;    ///< per sequence: none, 1 for all heads, or one per head; float32 if any
};

/// Queries, keys and values in the layout that the kernels want. Different rows may be set from
/// different threads at the same time.
class AttentionOperands {
 public:
  AttentionOperands(const Compute& compute, const AttentionShape& shape);

  /// `x` holds head_dim values of one head. Queries are scaled by 1 / sqrt(head_dim) here.
  void set_query(int64_t sequence, int64_t head, int64_t index, const float* x);
  void set_key(int64_t sequence, int64_t head, int64_t index, const float* x);
  void set_value(int64_t sequence, int64_t head, int64_t index, const float* x);
  /// All heads of a row of heads * head_dim values.
  void set_query_row(int64_t sequence, int64_t index, const float* x);
  void set_key_row(int64_t sequence, int64_t index, const float* x);
  void set_value_row(int64_t sequence, int64_t index, const float* x);

  const AttentionShape& shape() const { return shape_; }

 private:
  friend void attention(Compute&, const AttentionOperands&, float*, const uint8_t*);
  struct Range {
    int64_t begin, count;
  };
  /// The scores [keys, 16] of masked keys become so low that they weigh nothing.
  void hide_keys(const Range& keys, const Range& queries, const uint8_t* masked, float* scores) const;
  void attend_in_vectors(int64_t stream, int64_t first, int64_t count, const uint8_t* masked, float* out,
                         Scratch& scratch) const;
  void attend_amx(int64_t stream, int64_t first, int64_t count, float* out, Scratch& scratch) const;

  AttentionShape shape_;
  bool amx_;
  float scale_;
  int64_t padded_dim_, padded_queries_, padded_keys_;
  AlignedBytes queries_, keys_, values_;
};

/// out [sequences * queries, heads * head_dim]. masked [sequences, masks, queries, keys], or null:
/// not zero where a query does not attend to a key (every query has at least one key left).
void attention(Compute& compute, const AttentionOperands& operands, float* out, const uint8_t* masked = nullptr);

}  // namespace aligngs::nn
