#include "edit/fill/near_cells.h"

#include <algorithm>
#include <cmath>

namespace aligngs {

NearCells::NearCells(const std::vector<Vec3f>& points, double reach) {
  constexpr double kWider = 1.001, kLeast = 1e-6;  // a cell next to the place's holds all that is in reach
  edge_ = std::max(kWider * reach, kLeast);
  for (const Vec3f& p : points) taken_.push_back(cell_of(p));
  std::sort(taken_.begin(), taken_.end());
  taken_.erase(std::unique(taken_.begin(), taken_.end()), taken_.end());
}

NearCells::Cell NearCells::cell_of(const Vec3f& place) const {
  Cell cell;
  for (int a = 0; a < 3; ++a)
    cell[static_cast<size_t>(a)] = static_cast<int>(std::floor(static_cast<double>(place[a]) / edge_));
  return cell;
}

bool NearCells::may_be_near(const Vec3f& place) const {
  const Cell middle = cell_of(place);
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      // The three cells of a row are consecutive in the list.
      const Cell first{middle[0] + i, middle[1] + j, middle[2] - 1}, last{first[0], first[1], middle[2] + 1};
      const auto it = std::lower_bound(taken_.begin(), taken_.end(), first);
      if (it != taken_.end() && *it <= last) return true;
    }
  }
  return false;
}

}  // namespace aligngs
