// One row of the comparison of blended normals with the normals that the depth map implies. It is laid out in arrays,
// so that several pixels are computed at a time.
#pragma once

#include <cstddef>

namespace aligngs {

/// Arrays of `width` values each, one after the other. Neighbours are those of the depth stencil. An offset is the
/// neighbour's distance from the pixel, in pixels (0 where a one-sided difference uses the pixel itself).
enum NormalRowInput {
  kInRight,
  kInLeft,
  kInTop,
  kInBottom,  // depths
  kInRightOffset,
  kInLeftOffset,
  kInTopOffset,
  kInBottomOffset,  // 1 | 0, -1 | 0, -1 | 0, 1 | 0
  kInUsed           // 1 | 0
};
enum NormalRowOutput {
  kOutLoss,  // 1 - n . n_depth, 0 where not used
  kOutNormalX,
  kOutNormalY,
  kOutNormalZ,  // weight * dL / dN
  kOutRight,
  kOutLeft,
  kOutTop,
  kOutBottom  // weight * dL / dz of the neighbours
};
inline constexpr int kNormalRowInputs = kInUsed + 1;
inline constexpr int kNormalRowOutputs = kOutBottom + 1;

/// Rays of the row: pixel x has the ray ((x + first_x) step_x, ray_y, 1).
template <class T>
struct NormalRowGeometry {
  int width = 0;
  T first_x{}, step_x{}, ray_y{}, step_y{};
  T weight{};  ///< factor of the gradients
};

/// The depth normal is (right - left) x (top - bottom) of the unprojected neighbours, unit, turned to the camera.
/// n_x, n_y, n_z: unit blended normals; inverse_length: 1 / |N|.
void compute_normal_row(const NormalRowGeometry<float>& geometry, const float* in, const float* n_x, const float* n_y,
                        const float* n_z, const float* inverse_length, float* out);
void compute_normal_row(const NormalRowGeometry<double>& geometry, const double* in, const double* n_x,
                        const double* n_y, const double* n_z, const double* inverse_length, double* out);

}  // namespace aligngs
