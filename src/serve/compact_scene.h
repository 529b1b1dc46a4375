// The splats of a room as the page loads them: small numbers, compressed, the most visible splats first.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "serve/splat_table.h"

namespace aligngs {

/// Two gzip streams. Each begins with a line of JSON, {"total", "shown", "columns": [{"name", "type", "step", "first",
/// "count", "log", "delta"}]}. The columns follow: each has `count` numbers of `type` (i16, u16, i8, u8; little-endian)
/// for splats from `first` on. A value is number x step. "delta": numbers are differences from the one before, modulo
/// 2^16. "log": the value is sign(v) ln(1 + |v|).
struct CompactScene {
  std::string coarse;           ///< the first `shown` splats without their higher harmonics
  std::string rest;             ///< the other splats, and the harmonics of all
  std::vector<uint32_t> order;  ///< row of the table of each splat
};

/// Splats that nobody can see (an opacity below 1/255) are left out. The page draws the others within 1/255 of their
/// colours and 3 % of their sizes.
CompactScene compact_scene(const SplatTable& table);

}  // namespace aligngs
