#include "core/matrix_tiles.h"

#include <cstdint>

#include "core/error.h"

#ifdef ALIGNGS_MATRIX_TILES
#include <cpuid.h>
#include <immintrin.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace aligngs {

#ifdef ALIGNGS_MATRIX_TILES
namespace {

/// Layout of LDTILECFG (Intel SDM vol. 1, 18.3): palette 1, eight tiles of 16 rows of 64 bytes.
struct alignas(64) TileShapes {
  uint8_t palette = 1, start_row = 0, reserved[14] = {};
  uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
  uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16, 16};
};
static_assert(sizeof(TileShapes) == 64, "the processor reads 64 bytes");

bool has_bits(unsigned leaf, unsigned subleaf, unsigned eax_bits, unsigned ebx_bits, unsigned edx_bits) {
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid_count(leaf, subleaf, &a, &b, &c, &d) == 0) return false;
  return (a & eax_bits) == eax_bits && (b & ebx_bits) == ebx_bits && (d & edx_bits) == edx_bits;
}

bool detect() {
  constexpr unsigned kAvx512 = (1u << 16) | (1u << 17) | (1u << 30) | (1u << 31);  // leaf 7.0 ebx: F, DQ, BW, VL
  constexpr unsigned kAmx = (1u << 22) | (1u << 24);                               // leaf 7.0 edx: AMX-BF16, AMX-TILE
  constexpr unsigned kAvx512Bf16 = 1u << 5;                                        // leaf 7.1 eax
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512bw")) return false;  // the system's part
  if (!has_bits(7, 0, 0, kAvx512, kAmx) || !has_bits(7, 1, kAvx512Bf16, 0, 0)) return false;
  constexpr long kRequestPermission = 0x1023, kTileData = 18;  // ARCH_REQ_XCOMP_PERM, XFEATURE_XTILEDATA
  return syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
}

__attribute__((target("amx-tile"))) void configure_tiles() {
  const TileShapes shapes;
  tile_memory_fence();
  _tile_loadconfig(&shapes);
}
__attribute__((target("amx-tile"))) void release_tiles() { _tile_release(); }

}  // namespace

bool matrix_tiles_available() {
  static const bool available = detect();
  return available;
}

MatrixTilesInUse::MatrixTilesInUse() { configure_tiles(); }
MatrixTilesInUse::~MatrixTilesInUse() { release_tiles(); }

#else

bool matrix_tiles_available() { return false; }
MatrixTilesInUse::MatrixTilesInUse() { throw_usage("this build has no matrix tiles"); }
MatrixTilesInUse::~MatrixTilesInUse() = default;

#endif

}  // namespace aligngs
