// The direction of the blended normal of a pixel, where it has one.
#pragma once

#include <cmath>

#include "engine/losses/depth_map.h"

namespace aligngs {

/// |N| must exceed this share of A: below it the blended normals cancel each other, no direction is left and
/// its derivative grows without bound.
inline constexpr double kNormalCoherence = 0.1;

template <class T>
struct UnitNormal {
  Vec3<T> direction;       ///< N / |N|
  T inverse_length = 0;    ///< 1 / |N|; 0 when the pixel has no direction
  bool valid() const { return inverse_length > T(0); }
};

/// Valid where A > 0.5, |N| > 0.1 A and the mask allows the pixel.
template <class T>
UnitNormal<T> unit_normal_at(const MapLossInputs<T>& in, size_t pixel) {
  UnitNormal<T> result;
  const T alpha = in.maps.alpha[pixel];
  if (!(alpha > T(kAlphaSurface)) || !pixel_counts(in.view, pixel)) return result;
  const size_t n = in.maps.pixels();
  const Vec3<T> blended{in.maps.normal[pixel], in.maps.normal[n + pixel], in.maps.normal[2 * n + pixel]};
  const T length = norm(blended);
  if (!(length > T(kNormalCoherence) * alpha) || !std::isfinite(length)) return result;
  result.inverse_length = T(1) / length;
  result.direction = blended * result.inverse_length;
  return result;
}

/// Adds dL / dN given dL / d(N / |N|) = g.
template <class T>
void add_normal_gradient(const UnitNormal<T>& normal, const Vec3<T>& g, size_t pixel, size_t pixels,
                         MapGradients<T>& gradients) {
  const Vec3<T> d = (g - normal.direction * dot(g, normal.direction)) * normal.inverse_length;
  gradients.normal[pixel] += d.x;
  gradients.normal[pixels + pixel] += d.y;
  gradients.normal[2 * pixels + pixel] += d.z;
}

}  // namespace aligngs
