#include "edit/fill/hole_gaps.h"

#include <utility>

namespace aligngs {

void close_gaps(const PlaneGrid& grid, const std::vector<uint8_t>& closed, size_t most_cells,
                std::vector<uint8_t>& hole) {
  constexpr int kSides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  std::vector<uint8_t> seen(grid.size(), 0);
  const std::vector<uint8_t> before = hole;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const size_t first = grid.index(column, row);
      if (closed[first] || before[first] || seen[first]) continue;
      std::vector<std::pair<int, int>> gap{{column, row}};
      seen[first] = 1;
      bool at_border = false, beside_hole = false;
      for (size_t k = 0; k < gap.size(); ++k) {
        for (const auto& side : kSides) {
          const int i = gap[k].first + side[0], j = gap[k].second + side[1];
          if (i < 0 || j < 0 || i >= grid.columns || j >= grid.rows) {
            at_border = true;
            continue;
          }
          const size_t at = grid.index(i, j);
          beside_hole |= before[at] != 0;
          if (closed[at] || before[at] || seen[at]) continue;
          seen[at] = 1;
          gap.emplace_back(i, j);
        }
      }
      if (at_border || !beside_hole || gap.size() > most_cells) continue;
      for (const auto& [i, j] : gap) hole[grid.index(i, j)] = 1;
    }
  }
}

}  // namespace aligngs
