// Rotations by rotation vectors: axis times angle in radians.
#pragma once

#include <cmath>

#include "core/quaternion.h"

namespace aligngs {

/// exp of the cross-product matrix of `turn`; the identity for the zero vector.
inline Mat3d rotation_of(const Vec3d& turn) {
  const double angle = norm(turn);
  if (angle < 1e-12) return Mat3d::identity();  // the sine's quotient is lost in rounding
  const Vec3d a = turn * (std::sin(angle / 2) / angle);
  return rotation_matrix(Quaterniond{std::cos(angle / 2), a.x, a.y, a.z});
}

/// The shortest one: rotation_of of it is `rotation`.
inline Vec3d rotation_vector_of(const Mat3d& rotation) {
  const Quaterniond q = quaternion_of(rotation);
  const Vec3d axis = q.w < 0 ? Vec3d{-q.x, -q.y, -q.z} : Vec3d{q.x, q.y, q.z};
  const double sine = norm(axis);
  if (sine < 1e-12) return axis * 2.0;  // the angle's quotient is lost in rounding
  return axis * (2 * std::atan2(sine, std::abs(q.w)) / sine);
}

}  // namespace aligngs
