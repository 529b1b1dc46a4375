// View-dependent colour of a Gaussian from spherical harmonics, and its derivative.
#pragma once

#include "core/spherical_harmonics.h"

namespace aligngs {

/// The direction in which a colour is evaluated: from the camera centre to the Gaussian, unit; the zero vector when
/// they coincide.
template <class T>
ALIGNGS_HD inline Vec3<T> view_direction(const Vec3<T>& position, const Vec3<T>& camera_centre) {
  return normalized(position - camera_centre);
}

/// colour = max(0, 0.5 + sum_k sh_k basis_k(direction)) per channel (3DGS). sh is [16][3], colour fastest.
template <class T>
ALIGNGS_HD inline Vec3<T> sh_color(int degree, const Vec3<T>& direction, const T* sh) {
  T basis[kShCoefficients];
  sh_basis(degree, direction, basis);
  Vec3<T> color{T(0.5), T(0.5), T(0.5)};
  for (int k = 0; k < sh_coefficient_count(degree); ++k) {
    for (int c = 0; c < 3; ++c) color[c] += sh[3 * k + c] * basis[k];
  }
  for (int c = 0; c < 3; ++c) color[c] = color[c] > T(0) ? color[c] : T(0);
  return color;
}

/// Adds dL/dsh to `dsh` ([16][3]) and returns dL/dposition through the direction. A channel clamped at 0 has no
/// gradient. d(v / |v|) = (I - d d^T) / |v|.
template <class T>
ALIGNGS_HD inline Vec3<T> sh_color_backward(int degree, const Vec3<T>& position, const Vec3<T>& camera_centre,
                                            const T* sh, const Vec3<T>& color, const Vec3<T>& dcolor, T* dsh) {
  const Vec3<T> direction = view_direction(position, camera_centre);
  T basis[kShCoefficients], weight[kShCoefficients];
  sh_basis(degree, direction, basis);
  Vec3<T> g = dcolor;
  for (int c = 0; c < 3; ++c) {
    if (!(color[c] > T(0))) g[c] = T(0);
  }
  for (int k = 0; k < sh_coefficient_count(degree); ++k) {
    weight[k] = T(0);
    for (int c = 0; c < 3; ++c) {
      dsh[3 * k + c] += g[c] * basis[k];
      weight[k] += g[c] * sh[3 * k + c];
    }
  }
  const T length = norm(position - camera_centre);
  if (!(length > T(0))) return {};
  const Vec3<T> ddirection = sh_basis_gradient(degree, direction, weight);
  return (ddirection - dot(ddirection, direction) * direction) * (T(1) / length);
}

}  // namespace aligngs
