#include "nn/attention.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/half.h"
#include "nn/cpu/amx_attention.h"
#include "nn/cpu/panels.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kKeyBlock = 192;  // scores of three panels of queries: 36 KB, which stay in the first or second cache
constexpr float kLog2e = 1.44269504f;
constexpr float kNever = -1e30f;  // a score that weighs nothing; finite, so that differences are

int64_t round_up(int64_t n, int64_t unit) { return (n + unit - 1) / unit * unit; }

}  // namespace

// Layouts, per sequence and head. In vectors: queries [queries/16][dim][16], keys [keys][dim], values
// [keys/192][dim][192]. Matrix unit: see amx_attention.h.
AttentionOperands::AttentionOperands(const Compute& compute, const AttentionShape& shape)
    : shape_(shape),
      amx_(compute.amx() && shape.masks == 0 && shape.head_dim <= kAmxHeadDim),
      scale_(kLog2e / std::sqrt(static_cast<float>(shape.head_dim))),
      padded_dim_(amx_ ? kAmxHeadDim : shape.head_dim),
      padded_queries_(round_up(shape.queries, amx_ ? kAmxQueries : kPanel)),
      padded_keys_(round_up(shape.keys, amx_ ? kAmxKeys : kKeyBlock)) {
  const size_t streams = static_cast<size_t>(shape.sequences * shape.heads);
  const size_t item = amx_ ? sizeof(uint16_t) : sizeof(float);
  const size_t dim = static_cast<size_t>(padded_dim_);
  queries_ = AlignedBytes(streams * size_t(padded_queries_) * dim * item);
  keys_ = AlignedBytes(streams * size_t(padded_keys_) * dim * item);
  values_ = AlignedBytes(streams * size_t(padded_keys_) * dim * item);
  // Padding has to be finite: it is multiplied by zero. The matrix unit pads dimensions as well, between other bytes.
  // Else padding lies in the last panel of queries and the last block of values.
  if (amx_) {
    for (AlignedBytes* bytes : {&queries_, &keys_, &values_}) std::memset(bytes->get(), 0, bytes->size());
    return;
  }
  const auto clear_last = [&](AlignedBytes& bytes, int64_t count, int64_t padded, int64_t unit) {
    if (count == padded) return;
    const size_t stream = size_t(padded) * dim * item, last = size_t(unit) * dim * item;
    for (size_t s = 1; s <= streams; ++s) std::memset(bytes.get() + s * stream - last, 0, last);
  };
  clear_last(queries_, shape.queries, padded_queries_, kPanel);
  clear_last(values_, shape.keys, padded_keys_, kKeyBlock);
}

void AttentionOperands::set_query(int64_t sequence, int64_t head, int64_t index, const float* x) {
  const int64_t base =
      (sequence * shape_.heads + head) * padded_queries_ * padded_dim_ + index / kPanel * kPanel * padded_dim_;
  const int64_t column = index % kPanel;
  if (amx_) {
    uint16_t* out = reinterpret_cast<uint16_t*>(queries_.get()) + base;
    for (int64_t d = 0; d < shape_.head_dim; ++d)
      out[(d / 2 * kPanel + column) * 2 + d % 2] = float_to_bfloat16(x[d] * scale_);
  } else {
    float* out = reinterpret_cast<float*>(queries_.get()) + base;
    for (int64_t d = 0; d < shape_.head_dim; ++d) out[d * kPanel + column] = x[d] * scale_;
  }
}

void AttentionOperands::set_key(int64_t sequence, int64_t head, int64_t index, const float* x) {
  const int64_t at = ((sequence * shape_.heads + head) * padded_keys_ + index) * padded_dim_;
  if (amx_) {
    uint16_t* out = reinterpret_cast<uint16_t*>(keys_.get()) + at;
    for (int64_t d = 0; d < shape_.head_dim; ++d) out[d] = float_to_bfloat16(x[d]);
  } else {
    std::copy_n(x, shape_.head_dim, reinterpret_cast<float*>(keys_.get()) + at);
  }
}

void AttentionOperands::set_value(int64_t sequence, int64_t head, int64_t index, const float* x) {
  const int64_t block = amx_ ? kAmxKeys : kKeyBlock;
  const int64_t base = (sequence * shape_.heads + head) * padded_keys_ * padded_dim_ +
                       index / block * block * padded_dim_ + index % block;
  if (amx_) {
    uint16_t* out = reinterpret_cast<uint16_t*>(values_.get()) + base;
    for (int64_t d = 0; d < shape_.head_dim; ++d) out[d * block] = float_to_bfloat16(x[d]);
  } else {
    float* out = reinterpret_cast<float*>(values_.get()) + base;
    for (int64_t d = 0; d < shape_.head_dim; ++d) out[d * block] = x[d];
  }
}

void AttentionOperands::set_query_row(int64_t sequence, int64_t index, const float* x) {
  for (int64_t h = 0; h < shape_.heads; ++h) set_query(sequence, h, index, x + h * shape_.head_dim);
}
void AttentionOperands::set_key_row(int64_t sequence, int64_t index, const float* x) {
  for (int64_t h = 0; h < shape_.heads; ++h) set_key(sequence, h, index, x + h * shape_.head_dim);
}
void AttentionOperands::set_value_row(int64_t sequence, int64_t index, const float* x) {
  for (int64_t h = 0; h < shape_.heads; ++h) set_value(sequence, h, index, x + h * shape_.head_dim);
}

void AttentionOperands::hide_keys(const Range& keys, const Range& queries, const uint8_t* masked, float* scores) const {
  for (int64_t i = 0; i < queries.count; ++i) {
    const uint8_t* row = masked + (queries.begin + i) * shape_.keys + keys.begin;
    for (int64_t j = 0; j < keys.count; ++j) {
      if (row[j]) scores[j * kPanel + i] = kNever;
    }
  }
}

void AttentionOperands::attend_in_vectors(int64_t stream, int64_t first, int64_t count, const uint8_t* masked,
                                          float* out, Scratch& scratch) const {
  const int64_t dim = padded_dim_;
  const float* q = reinterpret_cast<const float*>(queries_.get()) + stream * padded_queries_ * dim;
  const float* k = reinterpret_cast<const float*>(keys_.get()) + stream * padded_keys_ * dim;
  const float* v = reinterpret_cast<const float*>(values_.get()) + stream * padded_keys_ * dim;
  const int64_t panels = round_up(count, kPanel) / kPanel;
  constexpr int64_t kPanelScores = kKeyBlock * kPanel;
  float* scores = scratch.floats(size_t(kJoinedPanels * kPanelScores));
  float* most = scratch.floats(size_t(panels * kPanel));
  float* total = scratch.floats(size_t(panels * kPanel));
  float* sums = scratch.floats(size_t(panels * dim * kPanel));
  std::fill_n(most, panels * kPanel, kNever);
  std::fill_n(total, panels * kPanel, 0.0f);
  std::fill_n(sums, panels * dim * kPanel, 0.0f);
  for (int64_t begin = 0; begin < shape_.keys; begin += kKeyBlock) {
    const int64_t n = std::min(kKeyBlock, shape_.keys - begin);
    for (int64_t p = 0; p < panels; p += kJoinedPanels) {
      const int64_t joined = std::min(kJoinedPanels, panels - p), size = dim * kPanel;
      multiply_panels({k + begin * dim, dim, n, dim, q + first * dim + p * size, size, joined, scores, kPanel,
                       kPanelScores, false});
      for (int64_t i = p; i < p + joined; ++i) {
        float* const own = scores + (i - p) * kPanelScores;
        if (masked) hide_keys({begin, n}, {first + i * kPanel, std::min(kPanel, count - i * kPanel)}, masked, own);
        softmax_step({own, n, most + i * kPanel, total + i * kPanel, sums + i * size, dim});
      }
      multiply_panels(
          {v + begin * dim, kKeyBlock, dim, n, scores, kPanelScores, joined, sums + p * size, kPanel, size, true});
    }
  }
  const int64_t width = shape_.heads * dim;
  for (int64_t i = 0; i < count; ++i) {
    const float* column = sums + i / kPanel * dim * kPanel + i % kPanel;
    const float scale = 1.0f / total[i];
    for (int64_t d = 0; d < dim; ++d) out[i * width + d] = column[d * kPanel] * scale;
  }
}

void AttentionOperands::attend_amx(int64_t stream, int64_t first, int64_t count, float* out, Scratch& scratch) const {
  const auto halves = [](const AlignedBytes& bytes) { return reinterpret_cast<const uint16_t*>(bytes.get()); };
  AmxAttentionBlock block;
  block.queries = halves(queries_) + (stream * padded_queries_ + first) * padded_dim_;
  block.keys = halves(keys_) + stream * padded_keys_ * padded_dim_;
  block.values = halves(values_) + stream * padded_keys_ * padded_dim_;
  block.query_count = count;
  block.key_count = shape_.keys;
  block.head_dim = shape_.head_dim;
  block.out = out;
  block.out_stride = shape_.heads * shape_.head_dim;
  amx_attention(block, scratch);
}

void attention(Compute& compute, const AttentionOperands& operands, float* out, const uint8_t* masked) {
  const AttentionShape& shape = operands.shape();
  if ((shape.masks > 0) != (masked != nullptr))
    throw Error({ErrorKind::kFailed, "a mask is given or missing against the shape", {}, "attention", ""});
  // Queries that share each block of keys while it is in the cache.
  constexpr int64_t kQueryBlock = 256, kFewQueries = 2 * kJoinedPanels * kPanel;
  const int64_t block = operands.amx_ ? kQueryBlock : kFewQueries;
  const int64_t blocks = (shape.queries + block - 1) / block;
  const int64_t streams = shape.sequences * shape.heads;
  const auto attend = [&](int64_t task, Scratch& scratch) {
    const Scratch::Frame frame(scratch);
    const int64_t stream = task / blocks, first = task % blocks * block;
    const int64_t sequence = stream / shape.heads, head = stream % shape.heads;
    const int64_t count = std::min(block, shape.queries - first);
    float* to = out + ((sequence * shape.queries + first) * shape.heads + head) * shape.head_dim;
    scratch.count_operations(4.0 * double(count) * double(shape.keys) * double(shape.head_dim));
    if (operands.amx_) {
      operands.attend_amx(stream, first, count, to, scratch);
    } else {
      const int64_t mask = sequence * shape.masks + (shape.masks > 1 ? head : 0);
      const uint8_t* own = masked ? masked + mask * shape.queries * shape.keys : nullptr;
      operands.attend_in_vectors(stream, first, count, own, to, scratch);
    }
  };
  // A thread that takes whole streams reads their keys and values once. Few streams are shared by the threads.
  constexpr int64_t kManyStreams = 8;  // per thread: the last ones keep threads waiting for 1/16 of the time on average
  const int64_t chunk = streams >= kManyStreams * compute.pool().size() ? blocks : 1;
  compute.for_rows(streams * blocks, chunk, [&](int64_t begin, int64_t count, Scratch& scratch) {
    for (int64_t task = begin; task < begin + count; ++task) attend(task, scratch);
  });
}

}  // namespace aligngs::nn
