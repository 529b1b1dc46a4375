#include "engine/cpu/matrix_tiles.h"

#include <atomic>

#include "core/error.h"

#if defined(__x86_64__) && defined(__linux__) && !defined(ALIGNGS_SCALAR_ONLY)
#include <cpuid.h>
#include <immintrin.h>
#include <sys/syscall.h>
#include <unistd.h>
#define ALIGNGS_MATRIX_TILES 1
#endif

namespace aligngs::cpu {

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

/// The compilers' tile loads and stores do not all say that they touch memory.
inline void memory_fence() { std::atomic_signal_fence(std::memory_order_seq_cst); }

__attribute__((target("amx-tile"))) void configure_tiles() {
  const TileShapes shapes;
  memory_fence();
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
  memory_fence();
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
  memory_fence();
}

#else

namespace {
[[noreturn]] void no_tiles() { throw_usage("this build has no matrix tiles"); }
}  // namespace

bool matrix_tiles_available() { return false; }
MatrixTilesInUse::MatrixTilesInUse() { no_tiles(); }
MatrixTilesInUse::~MatrixTilesInUse() = default;
void tile_product(const TileProduct&) { no_tiles(); }

#endif

}  // namespace aligngs::cpu
