// The direction of the blended normal of a pixel, where it has one.
#pragma once

#include "engine/formulas/normal_terms.h"
#include "engine/losses/depth_map.h"

namespace aligngs {

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
  const Vec3<T> d = normal_gradient(normal, g);
  gradients.normal[pixel] += d.x;
  gradients.normal[pixels + pixel] += d.y;
  gradients.normal[2 * pixels + pixel] += d.z;
}

}  // namespace aligngs
