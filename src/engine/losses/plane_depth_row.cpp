#include "engine/losses/plane_depth_row.h"

#include <vector>

#include "core/target_clones.h"
#include "engine/formulas/depth_terms.h"

namespace aligngs {
namespace {

template <class T>
ALIGNGS_ALWAYS_INLINE void depth_row(const PlaneDepthRow<T>& row, T* __restrict depth, T* __restrict level) {
  const T* __restrict n_x = row.n_x;
  const T* __restrict n_y = row.n_y;
  const T* __restrict n_z = row.n_z;
  const T* __restrict distance = row.distance;
  const T* __restrict alpha = row.alpha;
  const T* __restrict expected = row.expected;
  const T first_x = row.first_x, step_x = row.step_x, ray_y = row.ray_y;
  for (int x = 0; x < row.width; ++x) {
    const T ray_x = (static_cast<T>(x) + first_x) * step_x;
    const T z = distance[x] * plane_slope(n_x[x], n_y[x], n_z[x], alpha[x], distance[x], ray_x, ray_y).inverse;
    const DepthSample<T> sample = judge_depth(z, alpha[x], expected[x]);
    level[x] = sample.level;
    depth[x] = sample.z;
  }
}

template <class T>
ALIGNGS_ALWAYS_INLINE void chain_row(const PlaneDepthRow<T>& row, const T* __restrict gradient, T* __restrict d_n_x,
                                     T* __restrict d_n_y, T* __restrict d_n_z, T* __restrict d_distance) {
  const T* __restrict n_x = row.n_x;
  const T* __restrict n_y = row.n_y;
  const T* __restrict n_z = row.n_z;
  const T* __restrict distance = row.distance;
  const T* __restrict alpha = row.alpha;
  const T first_x = row.first_x, step_x = row.step_x, ray_y = row.ray_y;
  for (int x = 0; x < row.width; ++x) {
    const T ray_x = (static_cast<T>(x) + first_x) * step_x, g = gradient[x];
    const PlaneSlope<T> slope = plane_slope(n_x[x], n_y[x], n_z[x], alpha[x], distance[x], ray_x, ray_y);
    const DepthGradient<T> d = plane_depth_gradient(g, slope, distance[x]);
    d_distance[x] += d.distance;
    d_n_x[x] += d.normal * ray_x;
    d_n_y[x] += d.normal * ray_y;
    d_n_z[x] += d.normal;
  }
}

ALIGNGS_TARGET_CLONES
void depth_of_row(const PlaneDepthRow<float>& row, float* depth, float* level) { depth_row<float>(row, depth, level); }
void depth_of_row(const PlaneDepthRow<double>& row, double* depth, double* level) {
  depth_row<double>(row, depth, level);
}

template <class T>
void depth_and_validity(const PlaneDepthRow<T>& row, T* depth, uint8_t* validity) {
  thread_local std::vector<T> level;
  level.resize(static_cast<size_t>(row.width));
  depth_of_row(row, depth, level.data());
  for (size_t x = 0; x < level.size(); ++x) validity[x] = static_cast<uint8_t>(level[x]);
}

}  // namespace

void compute_plane_depth_row(const PlaneDepthRow<float>& row, float* depth, uint8_t* validity) {
  depth_and_validity(row, depth, validity);
}
void compute_plane_depth_row(const PlaneDepthRow<double>& row, double* depth, uint8_t* validity) {
  depth_and_validity(row, depth, validity);
}

ALIGNGS_TARGET_CLONES
void chain_plane_depth_row(const PlaneDepthRow<float>& row, const float* gradient, float* d_n_x, float* d_n_y,
                           float* d_n_z, float* d_distance) {
  chain_row<float>(row, gradient, d_n_x, d_n_y, d_n_z, d_distance);
}
void chain_plane_depth_row(const PlaneDepthRow<double>& row, const double* gradient, double* d_n_x, double* d_n_y,
                           double* d_n_z, double* d_distance) {
  chain_row<double>(row, gradient, d_n_x, d_n_y, d_n_z, d_distance);
}

}  // namespace aligngs
