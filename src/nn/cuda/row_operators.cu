// Kernels of row_operators.h.
#include "nn/cuda/row_operators.h"

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"
#include "nn/cuda/activations.cuh"

namespace aligngs::cuda {

/// The row of the calling warp.
__device__ __forceinline__ size_t warp_row() { return item_index() / 32; }

__global__ void normalise_kernel(RowSpans s, const float* weight, const float* bias, float eps) {
  const size_t row = warp_row();
  if (row >= size_t(s.rows)) return;  // the whole warp
  const auto columns = static_cast<unsigned>(s.columns);
  const size_t first = row * columns;
  float sum = 0.0f;
  for (unsigned c = lane_index(); c < columns; c += 32) sum += s.x[first + c];
  const float mean = warp_sum(sum) / static_cast<float>(columns);
  float squares = 0.0f;
  for (unsigned c = lane_index(); c < columns; c += 32) {
    const float d = s.x[first + c] - mean;
    squares += d * d;
  }
  const float scale = 1.0f / std::sqrt(warp_sum(squares) / static_cast<float>(columns) + eps);
  for (unsigned c = lane_index(); c < columns; c += 32) {
    const float v = (s.x[first + c] - mean) * scale;
    s.y[first + c] = (weight == nullptr ? v : v * weight[c]) + (bias == nullptr ? 0.0f : bias[c]);
  }
}

__global__ void softmax_kernel(RowSpans s) {
  const size_t row = warp_row();
  if (row >= size_t(s.rows)) return;  // the whole warp
  const auto columns = static_cast<unsigned>(s.columns);
  const size_t first = row * columns;
  float most = -INFINITY;
  for (unsigned c = lane_index(); c < columns; c += 32) most = std::max(most, s.x[first + c]);
  most = warp_maximum(most);
  float sum = 0.0f;
  for (unsigned c = lane_index(); c < columns; c += 32) sum += std::exp(s.x[first + c] - most);
  const float scale = 1.0f / warp_sum(sum);
  for (unsigned c = lane_index(); c < columns; c += 32) s.y[first + c] = std::exp(s.x[first + c] - most) * scale;
}

__global__ void activate_kernel(RowSpans s, const float* bias, nn::Activation activation) {
  const size_t i = item_index();
  if (i >= s.y.size) return;
  s.y[i] = activated(bias == nullptr ? s.x[i] : s.x[i] + bias[i % size_t(s.columns)], activation);
}

__global__ void gated_silu_kernel(RowSpans s) {
  const size_t i = item_index(), columns = size_t(s.columns);
  if (i >= s.y.size) return;
  const size_t first = i / columns * 2 * columns + i % columns;
  s.y[i] = silu(s.x[first]) * s.x[first + columns];
}

__global__ void accumulate_kernel(RowSpans s, const float* bias, const float* scale, bool rectified) {
  const size_t i = item_index();
  if (i >= s.y.size) return;
  const size_t c = i % size_t(s.columns);
  float v = s.x[i];
  if (rectified && !(v > 0.0f)) v = 0.0f;
  if (bias != nullptr) v += bias[c];
  s.y[i] += scale == nullptr ? v : scale[c] * v;
}

__global__ void scale_kernel(RowSpans s, const float* scale, const float* shift, bool relu) {
  const size_t i = item_index();
  if (i >= s.y.size) return;
  const size_t c = i % size_t(s.columns);
  const float v = s.x[i] * scale[c] + shift[c];
  s.y[i] = relu && !(v > 0.0f) ? 0.0f : v;
}

/// A block per group. Sums in double: maps have a million values per group.
__global__ void __launch_bounds__(kElementThreads) group_kernel(RowSpans s, GroupStatistics g) {
  __shared__ double scratch[32];
  const auto size = static_cast<unsigned>(s.columns / g.groups);
  const size_t count = size_t(s.rows) * size, group = blockIdx.x;
  const auto value = [&](size_t i) { return double(s.x[i / size * size_t(s.columns) + group * size + i % size]); };
  double sum = 0;
  for (size_t i = threadIdx.x; i < count; i += kElementThreads) sum += value(i);
  const double mean = block_sum(sum, scratch) / double(count);
  double squares = 0;
  for (size_t i = threadIdx.x; i < count; i += kElementThreads) {
    const double d = value(i) - mean;
    squares += d * d;
  }
  const double scale = 1.0 / std::sqrt(block_sum(squares, scratch) / double(count) + g.eps);
  for (unsigned i = threadIdx.x; i < size; i += kElementThreads) {
    const size_t c = group * size + i;
    const double own = double(g.weight[c]) * scale;
    g.scale[c] = static_cast<float>(own);
    g.shift[c] = static_cast<float>(double(g.bias[c]) - mean * own);
  }
}

/// A warp per row and head of queries and keys: normalise_kernel the head, then rotate its halves.
__global__ void head_kernel(HeadSpans s) {
  const nn::HeadPreparation& h = s.heads;
  const size_t item = warp_row(), parts = size_t(2 * h.heads);
  if (item >= size_t(h.rows) * parts) return;  // the whole warp
  const size_t row = item / parts, part = item % parts;
  const auto dim = static_cast<unsigned>(h.head_dim), lane = lane_index();
  const size_t first = row * size_t(3 * h.heads * h.head_dim) + part * dim;
  const bool key = part >= size_t(h.heads);
  const float *weight = key ? h.k_weight : h.q_weight, *bias = key ? h.k_bias : h.q_bias;
  if (weight != nullptr) {
    float sum = 0.0f;
    for (unsigned d = lane; d < dim; d += 32) sum += s.qkv[first + d];
    const float mean = warp_sum(sum) / static_cast<float>(dim);
    float squares = 0.0f;
    for (unsigned d = lane; d < dim; d += 32) {
      const float v = s.qkv[first + d] - mean;
      squares += v * v;
    }
    const float scale = 1.0f / std::sqrt(warp_sum(squares) / static_cast<float>(dim) + h.eps);
    for (unsigned d = lane; d < dim; d += 32)
      s.qkv[first + d] = (s.qkv[first + d] - mean) * scale * weight[d] + bias[d];
  }
  if (h.cosines == nullptr) return;
  __syncwarp();
  // Pairs of the first half rotate with y, those of the second with x (ops/rope.h).
  const unsigned quarter = dim / 4;
  const size_t token = row % (s.places.size / 2);
  for (unsigned pair = lane; pair < 2 * quarter; pair += 32) {
    const unsigned half = pair / quarter, j = pair % quarter;
    const size_t at = size_t(s.places[2 * token + half]) * quarter + j, i = first + half * 2 * quarter + j;
    const float c = h.cosines[at], v = h.sines[at], a = s.qkv[i], b = s.qkv[i + quarter];
    s.qkv[i] = a * c - b * v;
    s.qkv[i + quarter] = b * c + a * v;
  }
}

__global__ void copy_kernel(BlockCopy c) {
  const size_t i = item_index();
  if (i >= size_t(c.rows * c.columns)) return;
  const size_t row = i / size_t(c.columns), column = i % size_t(c.columns);
  const float value = c.from[row * size_t(c.from_stride) + column];
  float& to = c.to[row * size_t(c.to_stride) + column];
  to = c.add ? to + value : value;
}
namespace {

LaunchShape warp_per_row(int64_t rows) { return one_per_item(size_t(rows) * 32, kElementThreads); }

}  // namespace

void normalise_rows(const DeviceContext& context, const RowSpans& spans, const float* weight, const float* bias,
                    float eps) {
  launch(context, "normalise_rows", normalise_kernel, warp_per_row(spans.rows), spans, weight, bias, eps);
}
void softmax(const DeviceContext& context, const RowSpans& spans) {
  launch(context, "softmax", softmax_kernel, warp_per_row(spans.rows), spans);
}
void activate(const DeviceContext& context, const RowSpans& spans, const float* bias, nn::Activation activation) {
  launch(context, "activate", activate_kernel, one_per_item(spans.y.size, kElementThreads), spans, bias, activation);
}
void gated_silu(const DeviceContext& context, const RowSpans& spans) {
  launch(context, "gated_silu", gated_silu_kernel, one_per_item(spans.y.size, kElementThreads), spans);
}
void accumulate(const DeviceContext& context, const RowSpans& spans, const float* bias, const float* scale,
                bool rectified) {
  launch(context, "accumulate", accumulate_kernel, one_per_item(spans.y.size, kElementThreads), spans, bias, scale,
         rectified);
}
void scale_and_shift(const DeviceContext& context, const RowSpans& spans, const float* scale, const float* shift,
                     bool relu) {
  launch(context, "scale_and_shift", scale_kernel, one_per_item(spans.y.size, kElementThreads), spans, scale, shift,
         relu);
}
void group_statistics(const DeviceContext& context, const RowSpans& spans, const GroupStatistics& statistics) {
  launch(context, "group_statistics", group_kernel,
         {dim3(static_cast<unsigned>(statistics.groups)), dim3(kElementThreads)}, spans, statistics);
}
void prepare_head_rows(const DeviceContext& context, const HeadSpans& spans) {
  if (spans.heads.q_weight == nullptr && spans.heads.cosines == nullptr) return;
  launch(context, "prepare_heads", head_kernel, warp_per_row(spans.heads.rows * 2 * spans.heads.heads), spans);
}
void copy_block(const DeviceContext& context, const BlockCopy& copy) {
  launch(context, "copy_block", copy_kernel, one_per_item(size_t(copy.rows * copy.columns), kElementThreads), copy);
}

}  // namespace aligngs::cuda
