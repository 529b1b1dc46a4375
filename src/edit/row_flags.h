// One flag per Gaussian.
#pragma once

#include <cstdint>
#include <vector>

namespace aligngs {

/// 1 where `flags` has 0, and 0 elsewhere.
inline std::vector<uint8_t> inverted(std::vector<uint8_t> flags) {
  for (uint8_t& flag : flags) flag = !flag;
  return flags;
}

/// Opacity from which on a Gaussian counts as part of a surface; fainter ones are haze.
inline constexpr float kSolidOpacity = 0.3f;

}  // namespace aligngs
