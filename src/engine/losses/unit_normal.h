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
  Vec3<T> direction;     ///< N / |N|
  T inverse_length = 0;  ///< 1 / |N|; 0 when the pixel has no direction
  bool valid() const { return inverse_length > T(0); }
};

/// Fills workspace.direction and .inverse_length: valid where A > 0.5, |N| > 0.1 A and the mask allows the pixel.
template <class T>
void compute_unit_normals(const MapLossInputs<T>& inputs, MapLossWorkspace<T>& workspace);

template <class T>
UnitNormal<T> unit_normal_at(const MapLossWorkspace<T>& workspace, size_t pixel) {
  const size_t n = workspace.inverse_length.size();
  return {{workspace.direction[pixel], workspace.direction[n + pixel], workspace.direction[2 * n + pixel]},
          workspace.inverse_length[pixel]};
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
