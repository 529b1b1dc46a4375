#include "edit/fill/grid_regions.h"

#include <gmock/gmock.h>

#include <string>

namespace aligngs {
namespace {

PlaneGrid grid_of(int columns, int rows) {
  PlaneGrid grid;
  grid.columns = columns;
  grid.rows = rows;
  return grid;
}

/// From rows of '#' and '.'.
CellRegion region_of(const std::string& picture) {
  CellRegion out;
  for (const char c : picture) {
    if (c != ' ') out.push_back(c == '#');
  }
  return out;
}

TEST(GridRegions, SumsAreOverTheCellsOfTheGridAlone) {
  const PlaneGrid grid = grid_of(3, 2);
  const SquareSums sums(grid, std::vector<float>{1, 2, 3, 4, 5, 6});
  EXPECT_EQ(sums.around(1, 0, 0), 2);
  EXPECT_EQ(sums.around(0, 0, 1), 1 + 2 + 4 + 5);
  EXPECT_EQ(sums.around(1, 1, 5), 21);
}

TEST(GridRegions, GrowInSquares) {
  EXPECT_EQ(grown(region_of(".... .#.. .... ...."), grid_of(4, 4), 1), region_of("###. ###. ###. ...."));
}

TEST(GridRegions, ClosingFillsGapsAndKeepsTheOutline) {
  EXPECT_EQ(closed(region_of("....... .##.##. .##.##. ......."), grid_of(7, 4), 1),
            region_of("....... .#####. .#####. ......."));
}

TEST(GridRegions, EnclosedCellsAreFilledAndBaysAreNot) {
  EXPECT_EQ(without_holes(region_of("..... .###. .#.#. .###. ....."), grid_of(5, 5)),
            region_of("..... .###. .###. .###. ....."));
  EXPECT_EQ(without_holes(region_of("..... .#.#. .#.#. .###. ....."), grid_of(5, 5)),
            region_of("..... .#.#. .#.#. .###. ....."));
}

TEST(GridRegions, ConnectedCellsShareEdgesNotCorners) {
  EXPECT_EQ(connected_to(region_of("#... .... ...."), region_of("##.. ..#. ..#."), grid_of(4, 3)),
            region_of("##.. .... ...."));
  EXPECT_EQ(connected_to(region_of("...# .... ...."), region_of("##.. ..#. ..#."), grid_of(4, 3)),
            region_of(".... .... ...."));
}

TEST(GridRegions, TheRimIsNextToTheOutside) {
  EXPECT_EQ(rim_of(region_of("..... .###. .###. .###. ....."), grid_of(5, 5)),
            region_of("..... .###. .#.#. .###. ....."));
}

}  // namespace
}  // namespace aligngs
