// The rate of AMX tile products.
#pragma once

#include <cstdint>

namespace aligngs {

/// The processor has bfloat16 tiles and the kernel lets this process use them.
bool amx_available();

/// Operations of amx_burn(rounds).
inline constexpr double kAmxOperationsPerRound = 4.0 * 2 * 16 * 16 * 32;

/// Four independent products of 16 x 32 by 32 x 16 per round, from registers. Only with amx_available().
void amx_burn(int64_t rounds);

}  // namespace aligngs
