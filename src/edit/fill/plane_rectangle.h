// The rectangle that a thing takes of a plane, turned as the thing is.
#pragma once

#include <vector>

#include "core/vec.h"

namespace aligngs {

struct PlaneRectangle {
  Vec2d centre, along;                       ///< `along` is unit
  double low[2] = {0, 0}, high[2] = {0, 0};  ///< from the centre, along `along` and to its left
  bool holds(const Vec2d& place, double margin) const;
};

/// Around places of a plane, in any unit; 2 % on every side may lie outside: strays. At least three places.
PlaneRectangle rectangle_of(const std::vector<Vec2d>& places);

}  // namespace aligngs
