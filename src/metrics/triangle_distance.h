// The point of a triangle that is nearest to another point.
#pragma once

#include <algorithm>

#include "core/vec.h"

namespace aligngs {

/// Nearest to `p` on the segment from `a` to `b`, which may be a single point.
inline Vec3d nearest_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
  return a + along * t;
}

/// Nearest to `p` on the triangle `a`, `b`, `c`: the foot of the perpendicular where it lies inside, else a point of an
/// edge.
/// A degenerate triangle is its edges.
inline Vec3d nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = cross(b - a, c - a);
  const double squared = dot(normal, normal);
  if (squared > 0) {
    const Vec3d foot = p - normal * (dot(p - a, normal) / squared);
    const bool inside = dot(cross(b - a, foot - a), normal) >= 0 && dot(cross(c - b, foot - b), normal) >= 0 &&
                        dot(cross(a - c, foot - c), normal) >= 0;
    if (inside) return foot;
  }
  Vec3d best = nearest_on_segment(p, a, b);
  for (const Vec3d& other : {nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)}) {
    if (norm(other - p) < norm(best - p)) best = other;
  }
  return best;
}

}  // namespace aligngs
