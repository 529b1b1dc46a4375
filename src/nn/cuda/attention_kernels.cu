// Kernels of attention_kernels.h. On tensor cores a block holds 64 queries and goes through the keys 64 at a time.
// Scores and sums stay in registers and are rescaled as larger scores appear. In float32 one warp has one query.
#include "nn/cuda/attention_kernels.h"

#include "device/constants.h"
#include "device/launch.h"
#include "device/tile_mma.cuh"

namespace aligngs::cuda {

inline constexpr float kLog2OfE = 1.44269504f;
inline constexpr float kNoScore = -1e30f;  ///< a score that weighs nothing; finite, so that differences are
inline constexpr int kAttentionThreads = 32 * kAttentionWarps;
inline constexpr int kAttentionQueries = 16 * kAttentionWarps;  ///< per block: a tile of rows for each warp
inline constexpr int kScoreTiles = kAttentionKeys / kMmaTile;

/// Input of one block.
struct AttentionStream {
  int64_t sequence, head, first_query;
};

__device__ __forceinline__ AttentionStream attention_stream(const nn::AttentionShape& shape, int64_t block,
                                                            int queries_per_block) {
  const int64_t tiles = (shape.queries + queries_per_block - 1) / queries_per_block, stream = block / tiles;
  return {stream / shape.heads, stream % shape.heads, block % tiles * queries_per_block};
}

/// `kCount` rows of a head, from row `first` on, as bfloat16 in shared memory; zeros beyond `rows` and head_dim.
template <int kDim, int kCount>
__device__ __forceinline__ void load_head_rows(DeviceSpan<const float> from, int64_t stride, int64_t sequence,
                                               int64_t rows, int64_t first, int64_t column, int dim, float scale,
                                               Bf16* shared) {
  for (int e = static_cast<int>(threadIdx.x); e < kCount * kDim; e += kAttentionThreads) {
    const int row = e / kDim, d = e % kDim;
    float value = 0.0f;
    if (d < dim && first + row < rows)
      value = from[size_t((sequence * rows + first + row) * stride + column + d)] * scale;
    shared[row * (kDim + 8) + d] = to_bf16(value);
  }
}

template <int kDimTiles>
__global__ void __launch_bounds__(kAttentionThreads) flash_kernel(AttentionSpans a) {
  constexpr int kDim = 16 * kDimTiles, kStride = kDim + 8;
  // 16 bytes: 8 operands
  __shared__ uint4 key_chunks[kAttentionKeys * kStride / 8], value_chunks[kAttentionKeys * kStride / 8];
  Bf16* const keys = reinterpret_cast<Bf16*>(key_chunks);
  Bf16* const values = reinterpret_cast<Bf16*>(value_chunks);
  static_assert(kAttentionQueries <= kAttentionKeys, "the queries pass through the memory of the keys");
  const nn::AttentionShape& shape = a.shape;
  const AttentionStream at = attention_stream(shape, blockIdx.x, kAttentionQueries);
  const int dim = static_cast<int>(shape.head_dim), warp = static_cast<int>(warp_index());
  const int64_t column = at.head * shape.head_dim;
  load_head_rows<kDim, kAttentionQueries>(a.queries, a.query_stride, at.sequence, shape.queries, at.first_query, column,
                                          dim, kLog2OfE / std::sqrt(static_cast<float>(dim)), keys);
  __syncthreads();
  TileOperand query[kDimTiles];
#pragma unroll
  for (int d = 0; d < kDimTiles; ++d) query[d] = load_left(keys + warp * 16 * kStride + d * 16, kStride);
  TileSum sums[kDimTiles];
#pragma unroll
  for (int d = 0; d < kDimTiles; ++d) sums[d].clear();
  // A lane holds values of two rows: of the first (bit 1 of their index not set) and of the one 8 below.
  float most[2] = {kNoScore, kNoScore}, total[2] = {0.0f, 0.0f};
  for (int64_t begin = 0; begin < shape.keys; begin += kAttentionKeys) {
    __syncthreads();
    load_head_rows<kDim, kAttentionKeys>(a.keys, a.key_stride, at.sequence, shape.keys, begin, column, dim, 1.0f, keys);
    load_head_rows<kDim, kAttentionKeys>(a.values, a.value_stride, at.sequence, shape.keys, begin, column, dim, 1.0f,
                                         values);
    __syncthreads();
    TileSum scores[kScoreTiles];
#pragma unroll
    for (int t = 0; t < kScoreTiles; ++t) {
      scores[t].clear();
#pragma unroll
      for (int d = 0; d < kDimTiles; ++d) {
        multiply_add(scores[t], query[d], load_right_transposed(keys + t * 16 * kStride + d * 16, kStride));
      }
    }
    float block_most[2] = {most[0], most[1]};
#pragma unroll
    for (int t = 0; t < kScoreTiles; ++t) {
#pragma unroll
      for (int i = 0; i < 8; ++i) {
        if (begin + t * 16 + TileSum::column_of(i) >= shape.keys) scores[t].value[i] = kNoScore;
        block_most[(i >> 1) & 1] = std::max(block_most[(i >> 1) & 1], scores[t].value[i]);
      }
    }
    float shrink[2];
#pragma unroll
    for (int r = 0; r < 2; ++r) {
      // The four lanes that share the rows.
      block_most[r] = std::max(block_most[r], __shfl_xor_sync(kFullWarp, block_most[r], 1));
      block_most[r] = std::max(block_most[r], __shfl_xor_sync(kFullWarp, block_most[r], 2));
      shrink[r] = std::exp2(most[r] - block_most[r]);
      most[r] = block_most[r];
      total[r] *= shrink[r];
    }
#pragma unroll
    for (int d = 0; d < kDimTiles; ++d) {
#pragma unroll
      for (int i = 0; i < 8; ++i) sums[d].value[i] *= shrink[(i >> 1) & 1];
    }
#pragma unroll
    for (int t = 0; t < kScoreTiles; ++t) {
#pragma unroll
      for (int i = 0; i < 8; ++i) {
        // Rounded as the product will have it, so that the weights that are used sum to one.
        const float p = to_float(to_bf16(std::exp2(scores[t].value[i] - most[(i >> 1) & 1])));
        scores[t].value[i] = p;
        total[(i >> 1) & 1] += p;
      }
      const TileOperand weights = left_operand(scores[t]);
#pragma unroll
      for (int d = 0; d < kDimTiles; ++d) {
        multiply_add(sums[d], weights, load_right(values + t * 16 * kStride + d * 16, kStride));
      }
    }
  }
#pragma unroll
  for (int r = 0; r < 2; ++r) {
    total[r] += __shfl_xor_sync(kFullWarp, total[r], 1);
    total[r] += __shfl_xor_sync(kFullWarp, total[r], 2);
  }
#pragma unroll
  for (int d = 0; d < kDimTiles; ++d) {
#pragma unroll
    for (int i = 0; i < 8; ++i) {
      const int64_t query_row = at.first_query + warp * 16 + TileSum::row_of(i);
      const int own = d * 16 + TileSum::column_of(i);
      if (query_row >= shape.queries || own >= dim) continue;
      const int64_t row = (at.sequence * shape.queries + query_row) * shape.heads + at.head;
      a.out[size_t(row * shape.head_dim + own)] = sums[d].value[i] / total[(i >> 1) & 1];
    }
  }
}

inline constexpr int kLaneDims = static_cast<int>(kMostHeadDim) / 32;

/// A warp per query, its lanes on 32 keys at a time, then on the dimensions of the head.
__global__ void __launch_bounds__(kAttentionThreads) attend_float_kernel(AttentionSpans a) {
  __shared__ float queries[kAttentionWarps][kMostHeadDim];
  const nn::AttentionShape& shape = a.shape;
  const AttentionStream at = attention_stream(shape, blockIdx.x, kAttentionWarps);
  const int dim = static_cast<int>(shape.head_dim), lane = static_cast<int>(lane_index()),
            warp = static_cast<int>(warp_index());
  const int64_t query_row = at.first_query + warp, column = at.head * shape.head_dim;
  if (query_row >= shape.queries) return;  // the whole warp
  float* const query = queries[warp];
  const float scale = kLog2OfE / std::sqrt(static_cast<float>(dim));
  for (int d = lane; d < dim; d += 32) {
    query[d] = a.queries[size_t((at.sequence * shape.queries + query_row) * a.query_stride + column + d)] * scale;
  }
  __syncwarp();
  const int64_t mask_row =
      ((at.sequence * shape.masks + (shape.masks > 1 ? at.head : 0)) * shape.queries + query_row) * shape.keys;
  float most = kNoScore, total = 0.0f, sums[kLaneDims] = {};
  for (int64_t begin = 0; begin < shape.keys; begin += 32) {
    const int64_t key = begin + lane;
    float score = kNoScore;
    if (key < shape.keys && (a.masked.empty() || a.masked[size_t(mask_row + key)] == 0)) {
      const size_t first = size_t((at.sequence * shape.keys + key) * a.key_stride + column);
      score = 0.0f;
      for (int d = 0; d < dim; ++d) score += query[d] * a.keys[first + size_t(d)];
    }
    const float block_most = std::max(most, warp_maximum(score)), shrink = std::exp2(most - block_most);
    const float weight = key < shape.keys ? std::exp2(score - block_most) : 0.0f;
    most = block_most;
    total = total * shrink + warp_sum(weight);
#pragma unroll
    for (int j = 0; j < kLaneDims; ++j) sums[j] *= shrink;
    const int count = static_cast<int>(shape.keys - begin < 32 ? shape.keys - begin : 32);
    for (int k = 0; k < count; ++k) {
      const float w = __shfl_sync(kFullWarp, weight, k);
      const size_t first = size_t((at.sequence * shape.keys + begin + k) * a.value_stride + column);
#pragma unroll
      for (int j = 0; j < kLaneDims; ++j) {
        const int d = lane + 32 * j;
        if (d < dim) sums[j] += w * a.values[first + size_t(d)];
      }
    }
  }
  const int64_t row = (at.sequence * shape.queries + query_row) * shape.heads + at.head;
#pragma unroll
  for (int j = 0; j < kLaneDims; ++j) {
    const int d = lane + 32 * j;
    if (d < dim) a.out[size_t(row * shape.head_dim + d)] = sums[j] / total;
  }
}
namespace {

unsigned blocks_of(const nn::AttentionShape& shape, int64_t queries_per_block) {
  return static_cast<unsigned>(shape.sequences * shape.heads *
                               ((shape.queries + queries_per_block - 1) / queries_per_block));
}

template <int kDimTiles>
void launch_flash(const DeviceContext& context, const AttentionSpans& spans) {
  launch(context, "flash", flash_kernel<kDimTiles>,
         {dim3(blocks_of(spans.shape, kAttentionQueries)), dim3(kAttentionThreads)}, spans);
}

}  // namespace

void attention_bf16(const DeviceContext& context, const AttentionSpans& spans) {
  const int64_t dim = spans.shape.head_dim;
  if (dim <= 16) return launch_flash<1>(context, spans);
  if (dim <= 32) return launch_flash<2>(context, spans);
  if (dim <= 64) return launch_flash<4>(context, spans);
  launch_flash<8>(context, spans);
}

void attention_float(const DeviceContext& context, const AttentionSpans& spans) {
  launch(context, "attend_float", attend_float_kernel,
         {dim3(blocks_of(spans.shape, kAttentionWarps)), dim3(kAttentionThreads)}, spans);
}

}  // namespace aligngs::cuda
