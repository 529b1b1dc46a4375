// Quaternions (w, x, y, z) and rotation matrices.
#pragma once

#include "core/vec.h"

namespace aligngs {

template <class T>
struct Quaternion {
  T w{1}, x{}, y{}, z{};
};
using Quaterniond = Quaternion<double>;
using Quaternionf = Quaternion<float>;

template <class T>
ALIGNGS_HD inline T norm(const Quaternion<T>& q) {
  using std::sqrt;
  return sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}

/// q / |q|; a zero quaternion becomes the identity.
template <class T>
ALIGNGS_HD inline Quaternion<T> normalized(const Quaternion<T>& q) {
  const T n = norm(q);
  if (!(n > T(0))) return {};
  const T s = T(1) / n;
  return {q.w * s, q.x * s, q.y * s, q.z * s};
}

/// Rotation matrix of a unit quaternion.
template <class T>
ALIGNGS_HD inline Mat3<T> rotation_matrix(const Quaternion<T>& q) {
  return {{T(1) - T(2) * (q.y * q.y + q.z * q.z), T(2) * (q.x * q.y - q.w * q.z), T(2) * (q.x * q.z + q.w * q.y),
           T(2) * (q.x * q.y + q.w * q.z), T(1) - T(2) * (q.x * q.x + q.z * q.z), T(2) * (q.y * q.z - q.w * q.x),
           T(2) * (q.x * q.z - q.w * q.y), T(2) * (q.y * q.z + q.w * q.x), T(1) - T(2) * (q.x * q.x + q.y * q.y)}};
}

/// Unit quaternion (w >= 0) of a rotation matrix, by the largest diagonal term (Shepperd's method).
template <class T>
ALIGNGS_HD inline Quaternion<T> quaternion_of(const Mat3<T>& r) {
  using std::sqrt;
  const T trace = r(0, 0) + r(1, 1) + r(2, 2);
  Quaternion<T> q;
  if (trace > T(0)) {
    const T s = sqrt(trace + T(1)) * T(2);
    q = {s / T(4), (r(2, 1) - r(1, 2)) / s, (r(0, 2) - r(2, 0)) / s, (r(1, 0) - r(0, 1)) / s};
  } else if (r(0, 0) > r(1, 1) && r(0, 0) > r(2, 2)) {
    const T s = sqrt(T(1) + r(0, 0) - r(1, 1) - r(2, 2)) * T(2);
    q = {(r(2, 1) - r(1, 2)) / s, s / T(4), (r(0, 1) + r(1, 0)) / s, (r(0, 2) + r(2, 0)) / s};
  } else if (r(1, 1) > r(2, 2)) {
    const T s = sqrt(T(1) + r(1, 1) - r(0, 0) - r(2, 2)) * T(2);
    q = {(r(0, 2) - r(2, 0)) / s, (r(0, 1) + r(1, 0)) / s, s / T(4), (r(1, 2) + r(2, 1)) / s};
  } else {
    const T s = sqrt(T(1) + r(2, 2) - r(0, 0) - r(1, 1)) * T(2);
    q = {(r(1, 0) - r(0, 1)) / s, (r(0, 2) + r(2, 0)) / s, (r(1, 2) + r(2, 1)) / s, s / T(4)};
  }
  if (q.w < T(0)) q = {-q.w, -q.x, -q.y, -q.z};
  return normalized(q);
}

/// A rotation that takes the z axis to the given unit direction (used to lay flat Gaussians on a surface).
template <class T>
ALIGNGS_HD inline Quaternion<T> quaternion_from_z_to(const Vec3<T>& n) {
  if (n.z < T(-0.999999)) return {T(0), T(1), T(0), T(0)};  // half a turn about x
  return normalized(Quaternion<T>{T(1) + n.z, -n.y, n.x, T(0)});
}

}  // namespace aligngs
