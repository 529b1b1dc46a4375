// The room that measured depth encloses, as a convex body: where rays without depth leave it.
#pragma once

#include <vector>

#include "core/image.h"
#include "scene/camera.h"

namespace aligngs {

struct MeasuredHullSettings {
  int directions = 256;       ///< faces of the body, spread evenly
  double enclosed = 0.98;     ///< share of the points on the inner side of each face: reflections lie behind walls
  int stride = 4;             ///< every so many pixels of a map, in both directions
  size_t least_points = 500;  ///< fewer enclose nothing
};

/// A convex body of many faces around most points, and around all cameras.
class MeasuredHull {
 public:
  MeasuredHull() = default;
  /// Depth of views: H x W at the camera's size, scene units, 0 = none.
  MeasuredHull(const std::vector<Camera>& cameras, const std::vector<const ImageF*>& depths,
               const MeasuredHullSettings& settings = {});

  bool empty() const { return normals_.empty(); }
  /// Length along `direction` (in units of it) from `origin` to the body enlarged by `margin`; 0 from outside of it.
  double exit(const Vec3d& origin, const Vec3d& direction, double margin) const;
  /// How far outside a point lies, scene units; negative inside.
  double outside(const Vec3d& point) const;

 private:
  std::vector<Vec3d> normals_;  ///< unit, outwards
  std::vector<double> reach_;   ///< of the faces, along the normals
};

}  // namespace aligngs
