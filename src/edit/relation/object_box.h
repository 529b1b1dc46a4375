// The upright box around an object, without its stray Gaussians.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/plane_rectangle.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// Directions in which boxes of a room lie: `up` and two level ones, all unit and at right angles.
struct BoxAxes {
  explicit BoxAxes(const Vec3d& up);
  Vec2d on_floor(const Vec3d& place) const { return {dot(u, place), dot(v, place)}; }
  Vec3d u, v, up;
};

struct ObjectBox {
  PlaneRectangle footprint;      ///< in the coordinates of BoxAxes::on_floor, turned as the object is
  double low = 0, high = 0;      ///< along up, scene units
  double length = 0, width = 0;  ///< of the footprint's longer and shorter side

  double height() const { return high - low; }
  double middle_height() const { return 0.5 * (low + high); }
  /// Edges below `thinnest` count as that: flat things are compared by their area.
  double volume(double thinnest) const;
  /// Middle of the footprint, as BoxAxes::on_floor.
  Vec2d middle() const;
};

/// Two of a hundred Gaussians may lie outside on every side. They are strays, and one of them would double the volume.
/// Gaussians that hardly show do not count, unless the object has no others. Only a part of a large object's
/// Gaussians is looked at.
ObjectBox object_box(const GaussianModel& model, const std::vector<uint32_t>& rows, const BoxAxes& axes);

}  // namespace aligngs
