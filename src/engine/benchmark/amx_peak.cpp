#include "engine/benchmark/amx_peak.h"

#if defined(__x86_64__) && defined(__linux__) && !defined(ALIGNGS_SCALAR_ONLY)
#include <cpuid.h>
#include <immintrin.h>
#include <sys/syscall.h>
#include <unistd.h>
#define ALIGNGS_AMX_PEAK 1
#endif

namespace aligngs {

#ifdef ALIGNGS_AMX_PEAK
namespace {

/// Layout of LDTILECFG (Intel SDM vol. 1, 18.3): palette 1, eight tiles of 16 rows of 64 bytes.
struct alignas(64) TileConfig {
  uint8_t palette = 1, start_row = 0, reserved[14] = {};
  uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
  uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16, 16};
};
static_assert(sizeof(TileConfig) == 64, "the processor reads 64 bytes");

/// In memory of its own: compilers believe that the instruction reads eight bytes of its operand.
const TileConfig kTileConfig;

__attribute__((target("amx-tile,amx-bf16"))) void burn(int64_t rounds) {
  _tile_loadconfig(&kTileConfig);
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
  _tile_release();
}

}  // namespace

bool amx_available() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  constexpr unsigned kBf16Bit = 1u << 22, kTileBit = 1u << 24;  // of leaf 7, edx
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0 || (d & kBf16Bit) == 0 || (d & kTileBit) == 0) return false;
  constexpr long kRequestPermission = 0x1023, kTileData = 18;  // ARCH_REQ_XCOMP_PERM, XFEATURE_XTILEDATA
  return syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
}

void amx_burn(int64_t rounds) { burn(rounds); }
#else
bool amx_available() { return false; }
void amx_burn(int64_t) {}
#endif

}  // namespace aligngs
