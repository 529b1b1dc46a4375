// Stretches of an upright plane that are walls: nobody looks over or past them.
#pragma once

#include <vector>

#include "refine/scene_planes.h"
#include "room/seen_points.h"

namespace aligngs {

/// Lengths in metres.
struct WallPieceSettings {
  double cell = 0.10;         ///< side of the squares in which points are counted
  double on = 0.05;           ///< distance of points on the plane: trained walls are 1 to 3 cm thick
  double on_of_depth = 0.02;  ///< and as a share of the depth, whose errors grow with it
  double normal_angle = 35;   ///< degrees between the point's own normal and the plane's
  double beyond = 0.15;       ///< distance from which a point is behind the plane: a window's pane lies in its niche
  /// farther points are seen through a window or doorway, nearer ones are the wall behind a thing: cupboards are shallow
  double room_beyond = 1.0;
  double margin = 0.10;   ///< from floor and ceiling
  int least_votes = 2;    ///< points in a square that count
  int least_squares = 2;  ///< of a column through which one looks past the plane
  double bridged = 1.0;   ///< gap in a wall that is still one wall: a doorway up to the ceiling, a cupboard before it
  double least_length = 0.4;  ///< a chimney breast or pillar may be narrower and is left out
  double least_area = 0.4;    ///< square metres that are seen
  double least_top = 0.5;     ///< share of the room's height that it must reach: desks, beds and sofas end below
  /// share of its columns through which one looks past it: doorways are the rest
  double most_past = 0.5;
};

/// Heights between which a column of a wall is seen; high <= low: nowhere.
struct WallSpan {
  double low = 0, high = 0;
};

/// Along (-normal.y, normal.x) of its plane, and its columns from `first` on.
struct WallPiece {
  double first = 0, last = 0;
  std::vector<WallSpan> columns;
};

/// The place of a point on a plane's line, seen from above.
double along_plane(const ScenePlane& plane, const Vec3d& p);

/// Whether a point is on a plane.
bool is_on(const SeenPoint& point, const ScenePlane& plane, const WallPieceSettings& settings);

/// Whether a point is seen through one of the pieces. Through a window it is between places of its column; through a
/// doorway it is a room behind it.
bool is_seen_through(const std::vector<WallPiece>& pieces, const ScenePlane& plane, const SeenPoint& point, double low,
                     double high, const WallPieceSettings& settings);

/// A stretch is a wall when photos do not look past most of its columns. They look past a column above its highest
/// point on the plane, or below its lowest one where the wall behind is near. `low`, `high`: heights of floor and
/// ceiling; z is up.
std::vector<WallPiece> wall_pieces(const ScenePlane& plane, const std::vector<SeenPoint>& points, double low,
                                   double high, const WallPieceSettings& settings = {});

}  // namespace aligngs
