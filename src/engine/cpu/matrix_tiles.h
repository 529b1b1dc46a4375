// Products of bfloat16 matrices on AMX tiles: the one kernel that all semantic products use.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/matrix_tiles.h"

namespace aligngs::cpu {

inline constexpr size_t kTileRows = 16;   ///< rows of a tile, and columns of a result in float32
inline constexpr size_t kTileDepth = 32;  ///< terms of the inner sum per step: 64 bytes of bfloat16
inline constexpr size_t kTileNumbers = kTileRows * kTileDepth;  ///< of one operand

/// C = initial + sum over `steps` of A[step] B[step], for 32 rows and a multiple of 16 columns, float32 sums.
///   A: bfloat16, row r of a step's 32 terms at a + step * a_step + r * a_row.
///   B: bfloat16, pairs of terms are neighbours. Columns 0 to 15 of a step at b + step * b_step as [16][16][2], every
///      further 16 columns at kTileNumbers behind the last.
///   C: row r at c + r * c_row.
/// Offsets are in numbers, not bytes.
struct TileProduct {
  const uint16_t* a = nullptr;
  size_t a_row = 0, a_step = 0;
  const uint16_t* b = nullptr;
  size_t b_step = 0;
  const uint32_t* steps = nullptr;  ///< [step_count] indices
  size_t step_count = 0;
  size_t columns = 0;
  const float* initial = nullptr;  ///< [columns] one row, the same for all rows of C; nullptr: zeros
  float* c = nullptr;
  size_t c_row = 0;
};
void tile_product(const TileProduct& p);

}  // namespace aligngs::cpu
