// One row of plane depths and of their gradients, laid out so that it can be computed several pixels at a time. The
// guarded form of engine/formulas/plane_depth.h; the paper's is computed pixel by pixel (depth_map.cpp).
#pragma once

#include <cstdint>

namespace aligngs {

/// A row of the rendered maps; ray of pixel x: ((x + first_x) step_x, ray_y, 1).
template <class T>
struct PlaneDepthRow {
  int width = 0;
  T first_x{}, step_x{}, ray_y{};
  const T *n_x = nullptr, *n_y = nullptr, *n_z = nullptr, *distance = nullptr, *alpha = nullptr;
  const T* expected = nullptr;  ///< not read for gradients
};

/// depth[width] and DepthValidity validity[width], the mask not yet considered.
void compute_plane_depth_row(const PlaneDepthRow<float>& row, float* depth, uint8_t* validity);
void compute_plane_depth_row(const PlaneDepthRow<double>& row, double* depth, uint8_t* validity);

/// Adds what dL / dz = gradient[width] means for the maps. Pixels without a gradient are left as they are.
void chain_plane_depth_row(const PlaneDepthRow<float>& row, const float* gradient, float* d_n_x, float* d_n_y,
                           float* d_n_z, float* d_distance);
void chain_plane_depth_row(const PlaneDepthRow<double>& row, const double* gradient, double* d_n_x, double* d_n_y,
                           double* d_n_z, double* d_distance);

}  // namespace aligngs
