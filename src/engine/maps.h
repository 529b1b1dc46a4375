// Results of blending per pixel, and the gradients that the losses give back. Planar: channel c of pixel (x, y) is at
// [c * width * height + y * width + x].
#pragma once

#include <cstddef>
#include <vector>

namespace aligngs {

/// w_i are the blending weights, n_i the camera-frame plane normals turned to the camera, and d_i > 0 the plane
/// distances of the Gaussians. A point x of the plane has n_i . x = -d_i.
template <class T>
struct RenderMaps {
  int width = 0, height = 0;
  std::vector<T> color;     ///< 3 planes: sum w c + T_final * background
  std::vector<T> alpha;     ///< A = sum w = 1 - T_final
  std::vector<T> normal;    ///< 3 planes: N = sum w n, not normalised
  std::vector<T> distance;  ///< D = sum w d
  std::vector<T> expected;  ///< sum w z_i with z_i the intersection depth; not normalised; no gradient flows here
  std::vector<T> median;    ///< z_i of the first Gaussian after which transmittance < 0.5; 0 = none
  size_t pixels() const { return size_t(width) * height; }
};

/// dL / d map, same layouts. Maps that no loss touches stay zero.
template <class T>
struct MapGradients {
  std::vector<T> color, normal, distance, alpha;
  void reset(size_t pixels) {
    color.assign(3 * pixels, T(0));
    normal.assign(3 * pixels, T(0));
    distance.assign(pixels, T(0));
    alpha.assign(pixels, T(0));
  }
};

}  // namespace aligngs
