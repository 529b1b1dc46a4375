// The outline of a room seen from above: the cheapest closed line along walls around the space that photos show.
#pragma once

#include <vector>

#include "room/plan_evidence.h"

namespace aligngs {

struct RoomOutlineSettings {
  PlanEvidenceSettings evidence;
  double hidden_area = 0.35;    ///< cost of a square metre inside that no ray passes, where a free one outside costs 1
  double along_wall = 0.02;     ///< cost of a metre of outline along a seen wall, in square metres
  double along_unknown = 0.3;   ///< where no photo says
  double along_crossed = 2;     ///< and where photos see through
  double margin = 1;            ///< metres that the plan goes beyond the seen surfaces
  double box_quantile = 0.005;  ///< of the surfaces on each side that the box of the room leaves out: stray splats
  double near_box = 0.3;        ///< metres from a side of that box within which a wall closes the side
  /// metres: a shorter side between two parallel ones is taken for an error of their planes
  double least_side = 0.10;
  int most_lines = 24;  ///< walls with most points that are used
};

struct OutlineSide {
  PlanLine line;
  Vec2d from, to;
  SideEvidence evidence;
};

/// The sides in order, counter-clockwise, with corners where their lines meet; empty where there is no free space.
/// `lines` by falling number of points. If no wall closes a side of the box of the surfaces, the box does, along the
/// axes of the frame: such lines are assumed.
std::vector<OutlineSide> find_outline(std::vector<PlanLine> lines, const std::vector<SeenRay>& rays,
                                      const std::vector<RoomClass>& classes, const RoomOutlineSettings& settings = {});

}  // namespace aligngs
