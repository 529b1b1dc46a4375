// How much a textured surface resembles itself when it is shifted.
#pragma once

#include <cstddef>
#include <vector>

#include "edit/fill/texture_map.h"

namespace aligngs {

/// Correlation of a texture with itself, for shifts of at most `reach` cells along either axis. Only known cells count
/// (Padfield 2012, masked normalised cross-correlation), of the colour in which the texture varies most.
class SelfLikeness {
 public:
  /// Shifts for which fewer than `fewest` known cells lie on known cells have the correlation 0.
  SelfLikeness(const TextureMap& map, int reach, size_t fewest);

  int reach() const { return reach_; }
  /// In [-1, 1]; 0 beyond the reach.
  float at(int i, int j) const;

 private:
  size_t index(int i, int j) const {
    return static_cast<size_t>(j) * static_cast<size_t>(2 * reach_ + 1) + static_cast<size_t>(i + reach_);
  }
  int reach_;
  std::vector<float> values_;  ///< of the half plane j >= 0: the other half is the same
};

}  // namespace aligngs
