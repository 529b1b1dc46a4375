// Real spherical harmonics up to degree 3, in the order and sign convention of 3DGS files.
#pragma once

#include "core/vec.h"

namespace aligngs {

inline constexpr int kMaxShDegree = 3;
inline constexpr int kShCoefficients = 16;           ///< (kMaxShDegree + 1)^2
inline constexpr double kSh0 = 0.28209479177387814;  ///< 1 / (2 sqrt(pi)): the constant basis function

ALIGNGS_HD inline constexpr int sh_coefficient_count(int degree) { return (degree + 1) * (degree + 1); }

/// Writes the (degree + 1)^2 basis values at the unit direction d.
template <class T>
ALIGNGS_HD inline void sh_basis(int degree, const Vec3<T>& d, T* out) {
  out[0] = T(kSh0);
  if (degree < 1) return;
  const T x = d.x, y = d.y, z = d.z;
  const T c1 = T(0.4886025119029199);
  out[1] = -c1 * y;
  out[2] = c1 * z;
  out[3] = -c1 * x;
  if (degree < 2) return;
  const T xx = x * x, yy = y * y, zz = z * z;
  out[4] = T(1.0925484305920792) * x * y;
  out[5] = T(-1.0925484305920792) * y * z;
  out[6] = T(0.31539156525252005) * (T(2) * zz - xx - yy);
  out[7] = T(-1.0925484305920792) * x * z;
  out[8] = T(0.5462742152960396) * (xx - yy);
  if (degree < 3) return;
  out[9] = T(-0.5900435899266435) * y * (T(3) * xx - yy);
  out[10] = T(2.890611442640554) * x * y * z;
  out[11] = T(-0.4570457994644658) * y * (T(4) * zz - xx - yy);
  out[12] = T(0.3731763325901154) * z * (T(2) * zz - T(3) * xx - T(3) * yy);
  out[13] = T(-0.4570457994644658) * x * (T(4) * zz - xx - yy);
  out[14] = T(1.445305721320277) * z * (xx - yy);
  out[15] = T(-0.5900435899266435) * x * (xx - T(3) * yy);
}

/// Gradient of sum_k weight[k] * basis_k(d) with respect to d, with x, y, z taken as independent.
template <class T>
ALIGNGS_HD inline Vec3<T> sh_basis_gradient(int degree, const Vec3<T>& d, const T* weight) {
  Vec3<T> g;
  if (degree < 1) return g;
  const T x = d.x, y = d.y, z = d.z;
  const T c1 = T(0.4886025119029199);
  g.y += -c1 * weight[1];
  g.z += c1 * weight[2];
  g.x += -c1 * weight[3];
  if (degree < 2) return g;
  const T a = T(1.0925484305920792), b = T(0.31539156525252005), c = T(0.5462742152960396);
  g.x += a * (weight[4] * y - weight[7] * z) - T(2) * b * weight[6] * x + T(2) * c * weight[8] * x;
  g.y += a * (weight[4] * x - weight[5] * z) - T(2) * b * weight[6] * y - T(2) * c * weight[8] * y;
  g.z += a * (-weight[5] * y - weight[7] * x) + T(4) * b * weight[6] * z;
  if (degree < 3) return g;
  const T xx = x * x, yy = y * y, zz = z * z;
  const T c9 = T(-0.5900435899266435), c10 = T(2.890611442640554), c11 = T(-0.4570457994644658),
          c12 = T(0.3731763325901154), c14 = T(1.445305721320277);
  g.x += c9 * weight[9] * T(6) * x * y + c10 * weight[10] * y * z - c11 * weight[11] * T(2) * x * y -
         c12 * weight[12] * T(6) * x * z + c11 * weight[13] * (T(4) * zz - T(3) * xx - yy) +
         c14 * weight[14] * T(2) * x * z + c9 * weight[15] * T(3) * (xx - yy);
  g.y += c9 * weight[9] * T(3) * (xx - yy) + c10 * weight[10] * x * z +
         c11 * weight[11] * (T(4) * zz - xx - T(3) * yy) - c12 * weight[12] * T(6) * y * z -
         c11 * weight[13] * T(2) * x * y - c14 * weight[14] * T(2) * y * z - c9 * weight[15] * T(6) * x * y;
  g.z += c10 * weight[10] * x * y + c11 * weight[11] * T(8) * y * z +
         c12 * weight[12] * (T(6) * zz - T(3) * xx - T(3) * yy) + c11 * weight[13] * T(8) * x * z +
         c14 * weight[14] * (xx - yy);
  return g;
}

}  // namespace aligngs
