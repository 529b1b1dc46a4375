// The rate of AMX tile products.
#pragma once

#include <cstdint>

namespace aligngs {

/// Operations of amx_burn(rounds).
inline constexpr double kAmxOperationsPerRound = 4.0 * 2 * 16 * 16 * 32;

/// Four independent products of 16 x 32 by 32 x 16 per round, from registers. Only with
/// matrix_tiles_available() (core/matrix_tiles.h).
void amx_burn(int64_t rounds);

}  // namespace aligngs
