// Evidence of the photos for the floor plan: where there is free space, and along each line where a wall is or is none.
#pragma once

#include <vector>

#include "room/plan_cells.h"
#include "room/room_classes.h"
#include "room/seen_rays.h"

namespace aligngs {

/// Lengths in metres.
struct PlanEvidenceSettings {
  double cell = 0.05;  ///< side of the squares of free space and of the pieces of a line
  /// distance within which a surface labelled wall is on the line: a trained wall is 1 to 3 cm thick
  double on_wall = 0.10;
  double glass = 0.35;           ///< and within which a pane is: it lies in its niche, and its depth is uncertain
  double before_surface = 0.10;  ///< the last bit of a ray is not free
  double least_beyond = 0.25;    ///< a ray crosses a line when its surface lies so far beyond
};

/// Squares of the plan that rays pass.
struct FreeSpace {
  Vec2d low;
  double cell = 1;
  int columns = 0, rows = 0;
  std::vector<uint8_t> free;  ///< row-major from `low`
};

/// The height of a ray does not matter: what is free above a table is free. Panes and mirrors say nothing.
FreeSpace free_space(const Vec2d& low, const Vec2d& high, const std::vector<SeenRay>& rays,
                     const std::vector<RoomClass>& classes, const PlanEvidenceSettings& settings);

/// Votes along one line, in pieces of `cell` metres from `begin` along (-normal.y, normal.x).
struct LineEvidence {
  double begin = 0, cell = 1;
  std::vector<double> wall, crossed;
};

std::vector<LineEvidence> line_evidence(const std::vector<PlanLine>& lines, const Vec2d& low, const Vec2d& high,
                                        const std::vector<SeenRay>& rays, const std::vector<RoomClass>& classes,
                                        const PlanEvidenceSettings& settings);

/// Metres of a part of a line with a wall, without one, and without a photo that says.
struct SideEvidence {
  double wall = 0, crossed = 0, unknown = 0;
};
SideEvidence evidence_between(const PlanLine& line, const LineEvidence& evidence, const Vec2d& a, const Vec2d& b);

}  // namespace aligngs
