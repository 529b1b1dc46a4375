#include "engine/cpu/bf16_packing.h"

#include <cstring>

#include "core/error.h"
#include "engine/cpu/matrix_tiles.h"

#if defined(__x86_64__) && !defined(ALIGNGS_SCALAR_ONLY)
#if defined(__GNUC__) && !defined(__clang__)
// GCC 12 takes the undefined operands of its own intrinsics for mistakes (bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif
#include <immintrin.h>
#define ALIGNGS_PACKING_TARGET __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,avx512bf16")))
#define ALIGNGS_PACKING_INLINE ALIGNGS_PACKING_TARGET __attribute__((always_inline)) inline
#endif

namespace aligngs::cpu {

#ifdef ALIGNGS_PACKING_TARGET
namespace {

/// Rows lie anywhere in memory; a miss of the second-level cache lasts about as long as this many rows take.
constexpr size_t kPrefetchRows = 12;

/// 16 x 16 numbers of 32 bits: out[j][i] = in[i][j].
ALIGNGS_PACKING_INLINE void transpose_16x16(const __m512i* in, __m512i* out) {
  __m512i pairs[16], quads[16];
  for (int i = 0; i < 8; ++i) {
    pairs[2 * i] = _mm512_unpacklo_epi32(in[2 * i], in[2 * i + 1]);
    pairs[2 * i + 1] = _mm512_unpackhi_epi32(in[2 * i], in[2 * i + 1]);
  }
  for (int i = 0; i < 4; ++i) {  // quads[4 i + k]: column k of each group of four columns, rows 4 i .. 4 i + 3
    quads[4 * i] = _mm512_unpacklo_epi64(pairs[4 * i], pairs[4 * i + 2]);
    quads[4 * i + 1] = _mm512_unpackhi_epi64(pairs[4 * i], pairs[4 * i + 2]);
    quads[4 * i + 2] = _mm512_unpacklo_epi64(pairs[4 * i + 1], pairs[4 * i + 3]);
    quads[4 * i + 3] = _mm512_unpackhi_epi64(pairs[4 * i + 1], pairs[4 * i + 3]);
  }
  for (int k = 0; k < 4; ++k) {
    const __m512i upper_even = _mm512_shuffle_i32x4(quads[k], quads[4 + k], 0x88);
    const __m512i upper_odd = _mm512_shuffle_i32x4(quads[k], quads[4 + k], 0xdd);
    const __m512i lower_even = _mm512_shuffle_i32x4(quads[8 + k], quads[12 + k], 0x88);
    const __m512i lower_odd = _mm512_shuffle_i32x4(quads[8 + k], quads[12 + k], 0xdd);
    out[k] = _mm512_shuffle_i32x4(upper_even, lower_even, 0x88);
    out[4 + k] = _mm512_shuffle_i32x4(upper_odd, lower_odd, 0x88);
    out[8 + k] = _mm512_shuffle_i32x4(upper_even, lower_even, 0xdd);
    out[12 + k] = _mm512_shuffle_i32x4(upper_odd, lower_odd, 0xdd);
  }
}

/// Two rows of 16 numbers, rounded, [column][2]. Finite numbers only; ties away from zero.
ALIGNGS_PACKING_INLINE __m512i interleave_finite(__m512 first, __m512 second) {
  const __m512i half = _mm512_set1_epi32(0x8000);
  const __m512i low = _mm512_srli_epi32(_mm512_add_epi32(_mm512_castps_si512(first), half), 16);
  const __m512i high = _mm512_add_epi32(_mm512_castps_si512(second), half);
  return _mm512_mask_blend_epi16(0xaaaaaaaau, low, high);
}

/// 32 numbers, rounded, in order. Not a number stays not a number.
ALIGNGS_PACKING_INLINE __m512i round_32(__m512 first, __m512 second) {
  const __m512bh packed = _mm512_cvtne2ps_pbh(second, first);
  __m512i bits;
  std::memcpy(&bits, &packed, sizeof bits);  // __m512bh is a vector of integers or of its own type, by compiler
  return bits;
}

/// Index vector of vpermt2w that takes the low (or high) halves of two rows of 32 and interleaves them.
ALIGNGS_PACKING_INLINE __m512i interleave_index(int first) {
  alignas(64) uint16_t index[32];
  for (int i = 0; i < 16; ++i) {
    index[2 * i] = static_cast<uint16_t>(first + i);
    index[2 * i + 1] = static_cast<uint16_t>(32 + first + i);
  }
  return _mm512_load_si512(index);
}

}  // namespace

ALIGNGS_PACKING_TARGET void pack_weights(const float* const* weights, size_t row_stride, uint16_t* by_entry,
                                         uint16_t* by_pixel) {
  for (size_t e = 0; e < 32; ++e) {
    const float* w = weights[e];
    uint16_t* to = by_entry + e * row_stride;
    _mm512_store_si512(to, round_32(_mm512_load_ps(w), _mm512_load_ps(w + 16)));
    _mm512_store_si512(to + 32, round_32(_mm512_load_ps(w + 32), _mm512_load_ps(w + 48)));
  }
  for (size_t strip = 0; strip < kBlockPixels; strip += 16) {
    __m512i in[16], transposed[16];
    for (size_t p = 0; p < 16; ++p) {
      in[p] = interleave_finite(_mm512_load_ps(weights[2 * p] + strip), _mm512_load_ps(weights[2 * p + 1] + strip));
    }
    transpose_16x16(in, transposed);
    uint16_t* to = by_pixel + strip * 32;
    for (size_t p = 0; p < 16; ++p) _mm512_store_si512(to + 32 * p, transposed[p]);
  }
}

ALIGNGS_PACKING_TARGET void pack_rows(const uint16_t* const* rows, size_t count, size_t padded, uint16_t* plain,
                                      uint16_t* pairs) {
  const __m512i low = interleave_index(0), high = interleave_index(16), zero = _mm512_setzero_si512();
  const size_t depth = padded_depth(padded), groups = padded / kTileRows;
  for (size_t e = 0; e < padded_entries(count); e += 2) {
    for (size_t ahead = e + kPrefetchRows; ahead < count && ahead < e + kPrefetchRows + 2; ++ahead) {
      for (size_t c = 0; c < depth; c += 32) _mm_prefetch(reinterpret_cast<const char*>(rows[ahead] + c), _MM_HINT_T0);
    }
    uint16_t *first = plain + e * depth, *second = first + depth;
    uint16_t* to = pairs + (e / 32) * groups * kTileNumbers + (e % 32 / 2) * 32;
    for (size_t c = 0; c < depth; c += 32, to += 2 * kTileNumbers) {
      const __m512i a = e < count ? _mm512_load_si512(rows[e] + c) : zero;
      const __m512i b = e + 1 < count ? _mm512_load_si512(rows[e + 1] + c) : zero;
      _mm512_store_si512(first + c, a);
      _mm512_store_si512(second + c, b);
      _mm512_store_si512(to, _mm512_permutex2var_epi16(a, low, b));
      if (c + kTileRows < padded) _mm512_store_si512(to + kTileNumbers, _mm512_permutex2var_epi16(a, high, b));
    }
  }
}

ALIGNGS_PACKING_TARGET void pack_pixels(const float* in, size_t padded, uint16_t* out) {
  alignas(64) uint16_t order[32];
  for (int i = 0; i < 16; ++i) {
    order[2 * i] = static_cast<uint16_t>(i);
    order[2 * i + 1] = static_cast<uint16_t>(16 + i);
  }
  const __m512i interleave = _mm512_load_si512(order);
  const size_t groups = padded / kTileRows;
  for (size_t pixel = 0; pixel < kBlockPixels; pixel += 2) {
    const float *first = in + pixel * padded, *second = first + padded;
    uint16_t* to = out + (pixel / 32) * groups * kTileNumbers + (pixel % 32 / 2) * 32;
    for (size_t group = 0; group < groups; ++group) {
      const __m512i both =
          round_32(_mm512_load_ps(first + group * kTileRows), _mm512_load_ps(second + group * kTileRows));
      _mm512_store_si512(to + group * kTileNumbers, _mm512_permutexvar_epi16(interleave, both));
    }
  }
}

ALIGNGS_PACKING_TARGET void round_pixels(const float* in, size_t padded, uint16_t* out) {
  const size_t depth = padded_depth(padded);
  for (size_t pixel = 0; pixel < kBlockPixels; ++pixel) {
    const float* from = in + pixel * padded;
    for (size_t c = 0; c < padded; c += 32) {
      const __m512 second = c + 16 < padded ? _mm512_load_ps(from + c + 16) : _mm512_setzero_ps();
      _mm512_store_si512(out + pixel * depth + c, round_32(_mm512_load_ps(from + c), second));
    }
  }
}

ALIGNGS_PACKING_TARGET void pack_pixels_transposed(const uint16_t* in, size_t depth, uint16_t* out) {
  for (size_t c = 0; c < depth; c += 32) {
    for (size_t pixel = 0; pixel < kBlockPixels; pixel += 16) {
      __m512i rows[16], transposed[16];
      for (size_t p = 0; p < 16; ++p) rows[p] = _mm512_load_si512(in + (pixel + p) * depth + c);
      transpose_16x16(rows, transposed);
      uint16_t* to = out + c * kBlockPixels + (pixel / 16) * kTileNumbers;
      for (size_t p = 0; p < 16; ++p) _mm512_store_si512(to + 32 * p, transposed[p]);
    }
  }
}

#else

namespace {
[[noreturn]] void no_packing() { throw_usage("this build has no matrix tiles"); }
}  // namespace

void pack_weights(const float* const*, size_t, uint16_t*, uint16_t*) { no_packing(); }
void pack_rows(const uint16_t* const*, size_t, size_t, uint16_t*, uint16_t*) { no_packing(); }
void pack_pixels(const float*, size_t, uint16_t*) { no_packing(); }
void round_pixels(const float*, size_t, uint16_t*) { no_packing(); }
void pack_pixels_transposed(const uint16_t*, size_t, uint16_t*) { no_packing(); }

#endif

}  // namespace aligngs::cpu
