// The floor plan cut into convex pieces by the lines of all walls.
#pragma once

#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace aligngs {

/// A wall seen from above: points p with normal . p + offset = 0, the normal into the room.
struct PlanLine {
  Vec2d normal;  ///< unit
  double offset = 0;
  bool assumed = false;  ///< no photo shows it
  double distance(const Vec2d& p) const { return normal.x * p.x + normal.y * p.y + offset; }
};

/// Number of the line that an edge of a cell lies on; kPlanBorder: the border of the plan.
inline constexpr int kPlanBorder = -1;

struct PlanCell {
  std::vector<Vec2d> corners;  ///< counter-clockwise
  std::vector<int> lines;      ///< lines[k]: of the edge from corner k to the next
};

/// A side that two cells share, or that a cell has with the outside.
struct PlanSide {
  size_t cell = 0;
  int other = -1;   ///< the cell beyond; -1: outside
  size_t edge = 0;  ///< of `cell`
};

struct PlanCells {
  std::vector<PlanCell> cells;
  std::vector<PlanSide> sides;  ///< each shared side once, from the cell with the smaller number
};

/// The rectangle from `low` to `high`, cut by every line from border to border.
PlanCells cut_plan(const Vec2d& low, const Vec2d& high, const std::vector<PlanLine>& lines);

/// Whether a point lies in a convex cell.
bool contains(const PlanCell& cell, const Vec2d& p);

}  // namespace aligngs
