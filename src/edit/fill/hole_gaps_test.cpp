#include "edit/fill/hole_gaps.h"

#include <gtest/gtest.h>

#include <string>

namespace aligngs {
namespace {

/// Cells of a picture: '#' a surface, 'o' the hole, '.' neither.
std::string closed(const std::string& picture, int columns, size_t most_cells = 100) {
  PlaneGrid grid;
  grid.columns = columns;
  grid.rows = static_cast<int>(picture.size()) / columns;
  std::vector<uint8_t> surface, hole;
  for (const char c : picture) {
    surface.push_back(c == '#');
    hole.push_back(c == 'o');
  }
  close_gaps(grid, surface, most_cells, hole);
  std::string out = picture;
  for (size_t k = 0; k < out.size(); ++k) {
    if (hole[k]) out[k] = 'o';
  }
  return out;
}

TEST(CloseGaps, AGapInsideTheHoleIsFilled) {
  EXPECT_EQ(closed("######"
                   "#oooo#"
                   "#o.oo#"
                   "#oooo#"
                   "######",
                   6),
            "######"
            "#oooo#"
            "#oooo#"
            "#oooo#"
            "######");
}

TEST(CloseGaps, AGapBetweenTheHoleAndTheSurfaceIsFilled) {
  EXPECT_EQ(closed("#####"
                   "#oo.#"
                   "#oo.#"
                   "#####",
                   5),
            "#####"
            "#ooo#"
            "#ooo#"
            "#####");
}

TEST(CloseGaps, WhatReachesTheBorderStaysOpen) {
  const std::string picture =
      "##.##"
      "#o.o#"
      "#ooo#";
  EXPECT_EQ(closed(picture, 5), picture);
}

TEST(CloseGaps, AGapApartFromTheHoleIsNotTheFills) {
  const std::string picture =
      "#######"
      "#o#.###"
      "#######";
  EXPECT_EQ(closed(picture, 7), picture);
}

TEST(CloseGaps, ALargeGapStaysOpen) {
  const std::string picture =
      "######"
      "#o...#"
      "######";
  EXPECT_EQ(closed(picture, 6, 2), picture);
  EXPECT_NE(closed(picture, 6, 3), picture);
}

}  // namespace
}  // namespace aligngs
