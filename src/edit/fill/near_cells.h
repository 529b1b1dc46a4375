// A quick answer that no point of some is near a place.
#pragma once

#include <array>
#include <vector>

#include "core/vec.h"

namespace aligngs {

class NearCells {
 public:
  NearCells(const std::vector<Vec3f>& points, double reach);

  /// False only where every point is farther than the reach.
  bool may_be_near(const Vec3f& place) const;

 private:
  using Cell = std::array<int, 3>;
  Cell cell_of(const Vec3f& place) const;

  double edge_;              ///< a little more than the reach
  std::vector<Cell> taken_;  ///< those with points; ascending
};

}  // namespace aligngs
