#include "nn/cpu/amx_tiles.h"

#ifdef ALIGNGS_WITH_AMX

#include <cpuid.h>
#include <immintrin.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>

namespace aligngs::nn {
namespace {

bool ask_the_processor() {
  unsigned a, b, c, d;
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return false;
  constexpr unsigned kAvx512 = 1u << 16 | 1u << 17 | 1u << 30 | 1u << 31;  // F, DQ, BW, VL
  constexpr unsigned kAmx = 1u << 22 | 1u << 24;                           // BF16, TILE
  if ((b & kAvx512) != kAvx512 || (d & kAmx) != kAmx) return false;
  if (!__get_cpuid_count(7, 1, &a, &b, &c, &d) || !(a & 1u << 5)) return false;  // AVX512_BF16
  // Linux grants the tile registers to a process that asks (since 5.16).
  constexpr long kRequestPermission = 0x1023, kTileData = 18;
  return syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
}

struct alignas(64) TileConfig {
  uint8_t palette = 1;
  uint8_t start_row = 0;
  uint8_t reserved[14] = {};
  uint16_t row_bytes[16] = {};
  uint8_t rows[16] = {};
};

ALIGNGS_AMX_TARGET void configure() {
  TileConfig config;
  for (int i = 0; i < 8; ++i) {
    config.row_bytes[i] = 64;
    config.rows[i] = 16;
  }
  std::atomic_signal_fence(std::memory_order_seq_cst);  // compilers do not all know that the next line reads memory
  _tile_loadconfig(&config);
}

ALIGNGS_AMX_TARGET void release() { _tile_release(); }

}  // namespace

bool amx_usable() {
  static const bool usable = ask_the_processor();
  return usable;
}

TilesInUse::TilesInUse() { configure(); }
TilesInUse::~TilesInUse() { release(); }

}  // namespace aligngs::nn

#else

namespace aligngs::nn {
bool amx_usable() { return false; }
TilesInUse::TilesInUse() = default;
TilesInUse::~TilesInUse() = default;
}  // namespace aligngs::nn

#endif
