#include "engine/benchmark/amx_peak.h"

#include "core/matrix_tiles.h"

#ifdef ALIGNGS_MATRIX_TILES
#include <immintrin.h>
#endif

namespace aligngs {

#ifdef ALIGNGS_MATRIX_TILES
namespace {

__attribute__((target("amx-tile,amx-bf16"))) void burn(int64_t rounds) {
  const MatrixTilesInUse tiles;
  _tile_zero(0);
  _tile_zero(1);
  _tile_zero(2);
  _tile_zero(3);
  _tile_zero(4);
  _tile_zero(5);
  _tile_zero(6);
  _tile_zero(7);
  for (int64_t i = 0; i < rounds; ++i) {
    _tile_dpbf16ps(0, 4, 6);
    _tile_dpbf16ps(1, 4, 7);
    _tile_dpbf16ps(2, 5, 6);
    _tile_dpbf16ps(3, 5, 7);
  }
}

}  // namespace

void amx_burn(int64_t rounds) { burn(rounds); }
#else
void amx_burn(int64_t) {}
#endif

}  // namespace aligngs
