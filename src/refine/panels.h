// Flat things whose inside no photo and no network gets right: panes, mirrors, screens, pictures under glass.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "refine/scene_planes.h"

namespace aligngs {

/// One measured place on such a thing: its frame, a mullion, what can be matched of a picture.
struct PanelPoint {
  Vec3d position;        ///< world
  Vec3d camera;          ///< centre of the camera that measured it, world
  double depth = 0;      ///< from that camera, > 0; errors grow with it
  double certainty = 0;  ///< in (0, 1], of the measurement
  int view = 0;
  uint32_t part = 0;  ///< number of the connected region of one photo that it lies in; no two photos share one
};

/// A rectangle in a plane.
struct Panel {
  Vec3d normal;         ///< unit, towards the cameras
  double offset = 0;    ///< points x of the plane: normal . x + offset = 0
  Vec3d across, up;     ///< unit, in the plane, at right angles
  double low[2] = {};   ///< least coordinates along across and up, world
  double high[2] = {};  ///< and greatest
  double depth = 0;     ///< median of its points, from their cameras
  int views = 0;        ///< photos that measured it
  size_t points = 0;

  double distance(const Vec3d& x) const { return dot(normal, x) + offset; }
  Vec3d centre() const { return across * ((low[0] + high[0]) / 2) + up * ((low[1] + high[1]) / 2) - normal * offset; }
  /// Whether a point of the plane lies in the rectangle.
  bool contains(const Vec3d& x) const {
    const double u = dot(across, x), v = dot(up, x);
    return u >= low[0] && u <= high[0] && v >= low[1] && v <= high[1];
  }
};

/// Lengths are relative to the depth of the points, so that no unit is assumed.
struct PanelSettings {
  double cell = 0.04;      ///< regions of two photos with points in a cube of this side are of one thing
  int together = 3;        ///< points that each of them has there
  int candidates = 300;    ///< planes tried for each one found
  double inlier = 0.015;   ///< distance within which a point may belong to a plane
  double snap_angle = 12;  ///< degrees within which a panel is parallel to a wall
  size_t least_points = 60;
  int most_of_thing = 2;       ///< what a teacher takes for one thing can be a window and the curtains before it
  double least_share = 0.15;   ///< of the certainty of a thing's points: less, and it is not flat
  double level_cosine = 0.7;   ///< between a panel's normal and the floor's: above, it is a table top or the floor
  double least_spread = 0.03;  ///< standard deviation of its points along both directions: a line is no panel
  int least_views = 2;
  double rim = 0.01;  ///< that a rectangle goes beyond its points
};

/// The unit vector that the floor faces along and the ceiling against; nothing without either.
std::optional<Vec3d> vertical_of(const std::vector<ScenePlane>& planes);

/// Sets a panel's own directions from its normal. Level and upright where the planes have a floor or ceiling, else
/// along an axis of the world.
void set_upright(Panel& panel, const std::vector<ScenePlane>& planes);

/// The largest planes that each thing's measured points lie in. `planes` are those of the room: panels nearly parallel
/// to a wall are made parallel to it. Level ones are no panels. Rectangles are upright relative to the floor.
/// Deterministic for a seed; points that are not finite are ignored.
std::vector<Panel> find_panels(const std::vector<PanelPoint>& points, const std::vector<ScenePlane>& planes,
                               const PanelSettings& settings, uint64_t seed);

}  // namespace aligngs
