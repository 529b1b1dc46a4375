// The bfloat16 matrix tiles of x86 processors (AMX): whether they may be used, and their use by a thread.
#pragma once

#include <atomic>

#if defined(__x86_64__) && defined(__linux__) && !defined(ALIGNGS_SCALAR_ONLY)
#define ALIGNGS_MATRIX_TILES 1
#endif

namespace aligngs {

/// The processor has bfloat16 tiles and AVX-512 with bfloat16, and the kernel grants this process the use of tile data.
/// The first call asks for it. Always false in scalar-only builds.
bool matrix_tiles_available();

/// Gives each tile of this thread 16 rows of 64 bytes while it lives. Only with matrix_tiles_available(). Not to be
/// nested.
class MatrixTilesInUse {
 public:
  MatrixTilesInUse();
  ~MatrixTilesInUse();
  MatrixTilesInUse(const MatrixTilesInUse&) = delete;
  MatrixTilesInUse& operator=(const MatrixTilesInUse&) = delete;
};

/// Before tiles are loaded and after they are stored: the compilers' loads and stores do not all say that they touch
/// memory.
inline void tile_memory_fence() { std::atomic_signal_fence(std::memory_order_seq_cst); }

}  // namespace aligngs
