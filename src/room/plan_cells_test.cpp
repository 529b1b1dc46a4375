#include "room/plan_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "room/measured_room.h"

namespace aligngs {
namespace {

double whole_area(const PlanCells& plan) {
  double sum = 0;
  for (const PlanCell& cell : plan.cells) sum += signed_area(cell.corners);
  return sum;
}

size_t shared_sides(const PlanCells& plan) {
  return static_cast<size_t>(
      std::count_if(plan.sides.begin(), plan.sides.end(), [](const PlanSide& side) { return side.other >= 0; }));
}

TEST(PlanCells, WithoutLinesThePlanIsOneCell) {
  const PlanCells plan = cut_plan({0, 0}, {3, 2}, {});
  ASSERT_EQ(plan.cells.size(), 1u);
  EXPECT_EQ(plan.sides.size(), 4u);
  EXPECT_EQ(shared_sides(plan), 0u);
}

TEST(PlanCells, TwoCrossingLinesMakeFourCellsWithFourSharedSides) {
  const PlanCells plan = cut_plan({0, 0}, {3, 2}, {{{1, 0}, -1}, {{0, 1}, -1}});
  EXPECT_EQ(plan.cells.size(), 4u);
  EXPECT_EQ(shared_sides(plan), 4u);
  EXPECT_NEAR(whole_area(plan), 6, 1e-9);
}

TEST(PlanCells, SlantedLinesLeaveNoGapsAndNameTheirEdges) {
  const double s = std::sqrt(0.5);
  const std::vector<PlanLine> lines = {{{s, s}, -2 * s}, {{0, 1}, -0.7}, {{-s, s}, 0.3}};
  const PlanCells plan = cut_plan({0, 0}, {3, 2}, lines);
  EXPECT_NEAR(whole_area(plan), 6, 1e-9);
  for (const PlanSide& side : plan.sides) {
    const int line = plan.cells[side.cell].lines[side.edge];
    EXPECT_EQ(line == kPlanBorder, side.other < 0);
    if (line != kPlanBorder) {
      EXPECT_NEAR(lines[static_cast<size_t>(line)].distance(plan.cells[side.cell].corners[side.edge]), 0, 1e-9);
    }
  }
}

TEST(PlanCells, ALineThroughACornerAndOneOutsideCutNothingTwice) {
  const double s = std::sqrt(0.5);
  const PlanCells plan = cut_plan({0, 0}, {2, 2}, {{{s, -s}, 0}, {{1, 0}, 5}, {{s, -s}, 0}});
  EXPECT_EQ(plan.cells.size(), 2u);
  EXPECT_NEAR(whole_area(plan), 4, 1e-9);
}

TEST(PlanCells, APointIsInItsCellAlone) {
  const PlanCells plan = cut_plan({0, 0}, {2, 2}, {{{1, 0}, -1}});
  EXPECT_NE(contains(plan.cells[0], {0.5, 1}), contains(plan.cells[1], {0.5, 1}));
}

}  // namespace
}  // namespace aligngs
