// The gradient of a step's loss with respect to the pose of its camera, from the gradients of the Gaussians.
#pragma once

#include "core/rigid.h"
#include "engine/formulas/color.h"

namespace aligngs {

/// dL / d xi at xi = 0 of world_to_camera' = exp(xi) world_to_camera: a camera-frame point p moves to
/// p + rotation x p + translation.
template <class T>
struct PoseGradient {
  Vec3<T> rotation;     ///< per radian
  Vec3<T> translation;  ///< per scene unit
};

/// Values of the camera that a row's share needs.
template <class T>
struct PoseFrame {
  Mat3<T> rotation;  ///< world to camera
  Vec3<T> translation;
  Vec3<T> centre;  ///< in the world
};

/// A Gaussian as it was drawn, and the gradients of its parameters.
template <class T>
struct PoseRow {
  Vec3<T> position, dposition;
  const T* quaternion = nullptr;   ///< [4] w x y z, not normalised
  const T* dquaternion = nullptr;  ///< [4]
  const T* sh = nullptr;           ///< [16][3]
  const T* dsh = nullptr;          ///< [16][3]
};

/// World-frame torque of the quaternion's gradient: the derivative along rotation vectors w of exp(w) q at w = 0.
template <class T>
ALIGNGS_HD inline Vec3<T> quaternion_torque(const T* q, const T* g) {
  const T half = T(0.5);
  return {half * (g[1] * q[0] - g[0] * q[1] - g[2] * q[3] + g[3] * q[2]),
          half * (g[2] * q[0] - g[0] * q[2] + g[1] * q[3] - g[3] * q[1]),
          half * (g[3] * q[0] - g[0] * q[3] - g[1] * q[2] + g[2] * q[1])};
}

/// The part of dL/dposition that comes through the direction in which the colour is evaluated. dL/dcolour is read off
/// the constant coefficient's gradient.
template <class T>
ALIGNGS_HD inline Vec3<T> direction_part(int sh_degree, const Vec3<T>& position, const Vec3<T>& centre, const T* sh,
                                         const T* dsh) {
  const T length = norm(position - centre);
  if (sh_degree < 1 || !(length > T(0))) return {};
  T weight[kShCoefficients];
  for (int k = 0; k < sh_coefficient_count(sh_degree); ++k) {
    weight[k] = (dsh[0] * sh[3 * k] + dsh[1] * sh[3 * k + 1] + dsh[2] * sh[3 * k + 2]) * T(1 / kSh0);
  }
  const Vec3<T> direction = view_direction(position, centre), along = sh_basis_gradient(sh_degree, direction, weight);
  return (along - dot(along, direction) * direction) * (T(1) / length);
}

/// One row's share. A motion of the camera changes the picture as the opposite rigid motion of all Gaussians does, with
/// one exception. A camera that turns about its own centre keeps its viewing direction to every Gaussian.
template <class T>
ALIGNGS_HD inline PoseGradient<T> row_pose_gradient(const PoseFrame<T>& camera, const PoseRow<T>& row, int sh_degree) {
  const Vec3<T> geometric = row.dposition - direction_part(sh_degree, row.position, camera.centre, row.sh, row.dsh);
  const Vec3<T> point = camera.rotation * row.position + camera.translation;
  return {
      cross(point, camera.rotation * geometric) + camera.rotation * quaternion_torque(row.quaternion, row.dquaternion),
      camera.rotation * row.dposition};
}

}  // namespace aligngs
