#include "engine/cpu/matrix_tiles.h"

#include "core/error.h"

#ifdef ALIGNGS_MATRIX_TILES
#include <immintrin.h>
#endif

namespace aligngs::cpu {

#ifdef ALIGNGS_MATRIX_TILES
namespace {

// 2 x 2 tiles of sums: four products per four loads keep both the loads and the multipliers busy.
__attribute__((target("amx-tile,amx-bf16"), always_inline)) inline void product_32(const TileProduct& p,
                                                                                   const uint16_t* b_column,
                                                                                   const float* initial, float* c) {
  if (initial != nullptr) {
    _tile_loadd(0, initial, 0);  // a stride of zero repeats the row
    _tile_loadd(1, initial + kTileRows, 0);
    _tile_loadd(2, initial, 0);
    _tile_loadd(3, initial + kTileRows, 0);
  } else {
    _tile_zero(0);
    _tile_zero(1);
    _tile_zero(2);
    _tile_zero(3);
  }
  const size_t a_bytes = p.a_row * sizeof(uint16_t), lower = kTileRows * p.a_row;
  for (size_t i = 0; i < p.step_count; ++i) {
    const uint16_t* a = p.a + p.steps[i] * p.a_step;
    const uint16_t* b = b_column + p.steps[i] * p.b_step;
    _tile_loadd(4, a, a_bytes);
    _tile_loadd(6, b, 64);
    _tile_loadd(7, b + kTileNumbers, 64);
    _tile_loadd(5, a + lower, a_bytes);
    _tile_dpbf16ps(0, 4, 6);
    _tile_dpbf16ps(1, 4, 7);
    _tile_dpbf16ps(2, 5, 6);
    _tile_dpbf16ps(3, 5, 7);
  }
  const size_t c_bytes = p.c_row * sizeof(float);
  _tile_stored(0, c, c_bytes);
  _tile_stored(1, c + kTileRows, c_bytes);
  _tile_stored(2, c + kTileRows * p.c_row, c_bytes);
  _tile_stored(3, c + kTileRows * p.c_row + kTileRows, c_bytes);
}

__attribute__((target("amx-tile,amx-bf16"), always_inline)) inline void product_16(const TileProduct& p,
                                                                                   const uint16_t* b_column,
                                                                                   const float* initial, float* c) {
  if (initial != nullptr) {
    _tile_loadd(0, initial, 0);
    _tile_loadd(2, initial, 0);
  } else {
    _tile_zero(0);
    _tile_zero(2);
  }
  const size_t a_bytes = p.a_row * sizeof(uint16_t), lower = kTileRows * p.a_row;
  for (size_t i = 0; i < p.step_count; ++i) {
    const uint16_t* a = p.a + p.steps[i] * p.a_step;
    _tile_loadd(4, a, a_bytes);
    _tile_loadd(6, b_column + p.steps[i] * p.b_step, 64);
    _tile_loadd(5, a + lower, a_bytes);
    _tile_dpbf16ps(0, 4, 6);
    _tile_dpbf16ps(2, 5, 6);
  }
  const size_t c_bytes = p.c_row * sizeof(float);
  _tile_stored(0, c, c_bytes);
  _tile_stored(2, c + kTileRows * p.c_row, c_bytes);
}

}  // namespace

__attribute__((target("amx-tile,amx-bf16"), noinline)) void tile_product(const TileProduct& p) {
  tile_memory_fence();
  const uint16_t* b = p.b;
  const float* initial = p.initial;
  float* c = p.c;
  size_t left = p.columns;
  for (; left >= 2 * kTileRows; left -= 2 * kTileRows) {
    product_32(p, b, initial, c);
    b += 2 * kTileNumbers;
    c += 2 * kTileRows;
    if (initial != nullptr) initial += 2 * kTileRows;
  }
  if (left > 0) product_16(p, b, initial, c);
  tile_memory_fence();
}

#else

void tile_product(const TileProduct&) { throw_usage("this build has no matrix tiles"); }

#endif

}  // namespace aligngs::cpu
