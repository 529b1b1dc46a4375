// The Gaussians of a scene as a structure of arrays. Row i of every array belongs to Gaussian i.
#pragma once

#include <cstddef>
#include <vector>

#include "core/quaternion.h"
#include "core/spherical_harmonics.h"

namespace aligngs {

/// Scalar type T is float in use and double in gradient tests.
template <class T>
struct GaussianModelT {
  int semantic_channels = 0;      ///< C, 0 without semantics
  int sh_degree = 0;              ///< degree in use, 0..3; higher coefficients are kept but not evaluated
  std::vector<T> positions;       ///< [N][3] world
  std::vector<T> log_scales;      ///< [N][3] natural logarithm of the standard deviations
  std::vector<T> rotations;       ///< [N][4] quaternion w x y z, normalised on use
  std::vector<T> opacity_logits;  ///< [N]
  std::vector<T> sh;              ///< [N][16][3] coefficient-major, colour fastest (file order differs, see io)
  std::vector<T> semantics;       ///< [N][C] class logits

  size_t size() const { return opacity_logits.size(); }
  void resize(size_t n) {
    positions.resize(3 * n);
    log_scales.resize(3 * n);
    rotations.resize(4 * n);
    opacity_logits.resize(n);
    sh.resize(size_t(3) * kShCoefficients * n);
    semantics.resize(size_t(semantic_channels) * n);
  }
};

using GaussianModel = GaussianModelT<float>;

}  // namespace aligngs
