#include "nn/cpu/amx_attention.h"

#include "core/matrix_tiles.h"

#ifdef ALIGNGS_MATRIX_TILES

// GCC 12 finds its own undefined vectors uninitialised (bug 105593).
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <immintrin.h>

#include <algorithm>

// The functions below are compiled for instructions that the rest of the program does not assume.
#define ALIGNGS_AMX_TARGET __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,avx512bf16,amx-tile,amx-bf16")))

namespace aligngs::nn {
namespace {

constexpr int64_t kTileKeyBlock = 256;  // scores of 32 queries: 32 KB
constexpr int64_t kLane = 16;           // queries side by side in a vector
constexpr int64_t kDim = kAmxHeadDim;
constexpr float kTileNever = -1e30f;

/// Running results of 16 queries.
struct Lane {
  float* most;   // [16]
  float* total;  // [16]
  float* sums;   // [64][16]
};

/// 2^x within 1e-4, a twentieth of what rounding the result to bfloat16 costs.
ALIGNGS_AMX_TARGET inline __m512 exp2_rough(__m512 x) {
  constexpr int kDown = 1;  // x - floor(x)
  const __m512 f = _mm512_reduce_ps(x, kDown);
  __m512 p = _mm512_fmadd_ps(_mm512_set1_ps(0.078967257f), f, _mm512_set1_ps(0.224693156f));
  p = _mm512_fmadd_ps(p, f, _mm512_set1_ps(0.696324771f));
  p = _mm512_fmadd_ps(p, f, _mm512_set1_ps(0.999900288f));
  return _mm512_scalef_ps(p, x);
}

/// scores [keys][16] become weights [keys/2][16][2] in bfloat16; keys is even.
ALIGNGS_AMX_TARGET void softmax_lane(const float* scores, int64_t keys, const Lane& lane, uint16_t* weights) {
  const __m512 before = _mm512_loadu_ps(lane.most);
  __m512 most = before, other = before;
  for (int64_t k = 0; k < keys; k += 2) {
    most = _mm512_max_ps(most, _mm512_loadu_ps(scores + k * kLane));
    other = _mm512_max_ps(other, _mm512_loadu_ps(scores + (k + 1) * kLane));
  }
  most = _mm512_max_ps(most, other);
  alignas(64) static const uint16_t kInterleave[32] = {0, 16, 1, 17, 2,  18, 3,  19, 4,  20, 5,  21, 6,  22, 7,  23,
                                                       8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31};
  const __m512i interleave = _mm512_load_si512(kInterleave);
  __m512 even_total = _mm512_setzero_ps(), odd_total = _mm512_setzero_ps();
  for (int64_t k = 0; k < keys; k += 2) {
    const __m512 even = exp2_rough(_mm512_sub_ps(_mm512_loadu_ps(scores + k * kLane), most));
    const __m512 odd = exp2_rough(_mm512_sub_ps(_mm512_loadu_ps(scores + (k + 1) * kLane), most));
    even_total = _mm512_add_ps(even_total, even);
    odd_total = _mm512_add_ps(odd_total, odd);
    const __m512i pair = (__m512i)_mm512_cvtne2ps_pbh(odd, even);
    _mm512_storeu_si512(weights + k * kLane, _mm512_permutexvar_epi16(interleave, pair));
  }
  const __m512 change = exp2_rough(_mm512_sub_ps(before, most));
  const __m512 total = _mm512_add_ps(even_total, odd_total);
  _mm512_storeu_ps(lane.most, most);
  _mm512_storeu_ps(lane.total, _mm512_fmadd_ps(_mm512_loadu_ps(lane.total), change, total));
  if (_mm512_cmp_ps_mask(most, before, _CMP_NEQ_OQ) == 0) return;
  for (int64_t d = 0; d < kDim; ++d) {
    float* sum = lane.sums + d * kLane;
    _mm512_storeu_ps(sum, _mm512_mul_ps(_mm512_loadu_ps(sum), change));
  }
}

/// scores [keys][16] of two lanes = keys [keys][64] times their queries.
ALIGNGS_AMX_TARGET void score(const uint16_t* keys, int64_t count, const uint16_t* queries, float* scores0,
                              float* scores1) {
  constexpr int64_t kTileWords = 16 * 32;  // bfloat16 values of a tile
  constexpr int kKeyStride = int(kDim) * 2, kLine = 64;
  tile_memory_fence();
  _tile_loadd(4, queries, kLine);
  _tile_loadd(5, queries + kTileWords, kLine);
  _tile_loadd(6, queries + 2 * kTileWords, kLine);
  _tile_loadd(7, queries + 3 * kTileWords, kLine);
  for (int64_t k = 0; k < count; k += 16) {
    _tile_zero(0);
    _tile_zero(1);
    _tile_loadd(2, keys + k * kDim, kKeyStride);
    _tile_dpbf16ps(0, 2, 4);
    _tile_dpbf16ps(1, 2, 6);
    _tile_loadd(3, keys + k * kDim + 32, kKeyStride);
    _tile_dpbf16ps(0, 3, 5);
    _tile_dpbf16ps(1, 3, 7);
    _tile_stored(0, scores0 + k * kLane, kLine);
    _tile_stored(1, scores1 + k * kLane, kLine);
  }
  tile_memory_fence();
}

/// sums [64][16] of two lanes += values [keys/32][64][32] times their weights [keys/2][16][2].
ALIGNGS_AMX_TARGET void gather(const uint16_t* values, int64_t count, const uint16_t* weights0,
                               const uint16_t* weights1, float* sums0, float* sums1) {
  constexpr int kLine = 64;
  tile_memory_fence();
  for (int64_t d = 0; d < kDim; d += 32) {
    _tile_loadd(0, sums0 + d * kLane, kLine);
    _tile_loadd(1, sums0 + (d + 16) * kLane, kLine);
    _tile_loadd(2, sums1 + d * kLane, kLine);
    _tile_loadd(3, sums1 + (d + 16) * kLane, kLine);
    for (int64_t k = 0; k < count; k += 32) {
      _tile_loadd(4, values + k * kDim + d * 32, kLine);
      _tile_loadd(6, weights0 + k * kLane, kLine);
      _tile_dpbf16ps(0, 4, 6);
      _tile_loadd(5, values + k * kDim + (d + 16) * 32, kLine);
      _tile_dpbf16ps(1, 5, 6);
      _tile_loadd(7, weights1 + k * kLane, kLine);
      _tile_dpbf16ps(2, 4, 7);
      _tile_dpbf16ps(3, 5, 7);
    }
    _tile_stored(0, sums0 + d * kLane, kLine);
    _tile_stored(1, sums0 + (d + 16) * kLane, kLine);
    _tile_stored(2, sums1 + d * kLane, kLine);
    _tile_stored(3, sums1 + (d + 16) * kLane, kLine);
  }
  tile_memory_fence();
}

ALIGNGS_AMX_TARGET void attend(const AmxAttentionBlock& block, Scratch& scratch) {
  const int64_t lanes = (block.query_count + kAmxQueries - 1) / kAmxQueries * 2;
  float* scores0 = scratch.floats(size_t(kTileKeyBlock * kLane));
  float* scores1 = scratch.floats(size_t(kTileKeyBlock * kLane));
  uint16_t* weights0 = scratch.halves(size_t(kTileKeyBlock * kLane));
  uint16_t* weights1 = scratch.halves(size_t(kTileKeyBlock * kLane));
  float* most = scratch.floats(size_t(lanes * kLane));
  float* total = scratch.floats(size_t(lanes * kLane));
  float* sums = scratch.floats(size_t(lanes * kLane * kDim));
  std::fill_n(most, lanes * kLane, kTileNever);
  std::fill_n(total, lanes * kLane, 0.0f);
  std::fill_n(sums, lanes * kLane * kDim, 0.0f);
  const MatrixTilesInUse tiles;
  for (int64_t begin = 0; begin < block.key_count; begin += kTileKeyBlock) {
    const int64_t valid = std::min(kTileKeyBlock, block.key_count - begin);
    const int64_t count = (valid + kAmxKeys - 1) / kAmxKeys * kAmxKeys;
    for (int64_t l = 0; l < lanes; l += 2) {
      const auto lane_at = [&](int64_t i) {
        return Lane{most + i * kLane, total + i * kLane, sums + i * kLane * kDim};
      };
      const Lane lane0 = lane_at(l), lane1 = lane_at(l + 1);
      score(block.keys + begin * kDim, count, block.queries + l * kLane * kDim, scores0, scores1);
      if (valid < count) {
        std::fill_n(scores0 + valid * kLane, (count - valid) * kLane, kTileNever);
        std::fill_n(scores1 + valid * kLane, (count - valid) * kLane, kTileNever);
      }
      softmax_lane(scores0, count, lane0, weights0);
      softmax_lane(scores1, count, lane1, weights1);
      gather(block.values + begin * kDim, count, weights0, weights1, lane0.sums, lane1.sums);
    }
  }
  for (int64_t i = 0; i < block.query_count; ++i) {
    const float* column = sums + i / kLane * kLane * kDim + i % kLane;
    const float scale = 1.0f / total[i];
    float* out = block.out + i * block.out_stride;
    for (int64_t d = 0; d < block.head_dim; ++d) out[d] = column[d * kLane] * scale;
  }
}

}  // namespace

void amx_attention(const AmxAttentionBlock& block, Scratch& scratch) { attend(block, scratch); }

}  // namespace aligngs::nn

#else

namespace aligngs::nn {
void amx_attention(const AmxAttentionBlock&, Scratch&) {}
}  // namespace aligngs::nn

#endif
