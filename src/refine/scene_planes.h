// The planes of a room: walls, floor and ceiling, and tables, from labelled points of all photos.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace aligngs {

/// Kind of surface of a plane. Points of one kind never make a plane of another.
enum class PlaneKind : uint8_t { kNone, kWall, kFloor, kCeiling, kTable };

/// One place on a surface, as one photo has it.
struct PlanePoint {
  Vec3d position;        ///< world
  Vec3d normal;          ///< world, unit, towards the camera; only its rough direction is used
  double depth = 0;      ///< from its camera; errors of depth grow with it
  double certainty = 0;  ///< in [0, 1]: of a measurement by stereo; 0: the network's depth alone
  int view = 0;
  PlaneKind kind = PlaneKind::kNone;
  bool proud = false;  ///< of something flat a little before the plane: a door, a picture, a rug
};

/// Points x with normal . x + offset = 0; the normal points into the room.
struct ScenePlane {
  Vec3d normal;
  double offset = 0;
  Vec3d centre;  ///< of its points; lies in the plane
  PlaneKind kind = PlaneKind::kNone;
  double proud = 0;  ///< scene units: how far before the plane its proud points lie, on the mean
  int views = 0;     ///< photos that show it
  size_t points = 0;
  double distance(const Vec3d& x) const { return dot(normal, x) + offset; }
};

struct PlaneSettings {
  double inlier = 0.06;       ///< distance / depth within which a point may belong to a plane
  double normal_angle = 25;   ///< degrees between a point's normal and the plane's
  int candidates = 300;       ///< planes tried for each one found
  size_t least_points = 150;  ///< of a plane
  double least_share = 0.04;  ///< of all points of its kind
  int least_views = 2;
  double merge_angle = 8;        ///< degrees; planes of a kind this parallel
  double merge_distance = 0.04;  ///< and this near, relative to the depth of their points, are one
  /// Degrees: standard deviation of a plane's turn from the direction that it was found with; 0: any turn is as likely.
  double turn_sigma = 0;
  /// A network's depth of one photo is bent: its points on one plane are wrong together. They count as so many
  /// independent ones with this relative error.
  double prior_sigma = 0.02;
  double prior_independent = 4;
  double measured_sigma = 0.008;  ///< relative error of what stereo measured with certainty 1
  double measured_together = 50;  ///< points that count as one
  /// Distance of proud points before their plane, in shares of their depth: 1.5 +- 1.5 cm at 2.5 m. This is the
  /// thickness of door leaves and picture frames. Doors and pictures hold most of what stereo measures of a bare wall;
  /// taken for the wall, they bring it forward.
  double proud_mean = 0.006, proud_sigma = 0.006;
};

/// Planes by falling number of points, found one after the other by random candidates and refined by robust least
/// squares.
/// Deterministic for a seed. Points without finite position are ignored; too few points of a kind: no plane of it.
std::vector<ScenePlane> find_planes(const std::vector<PlanePoint>& points, const PlaneSettings& settings,
                                    uint64_t seed);

}  // namespace aligngs
