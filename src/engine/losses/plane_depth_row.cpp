#include "engine/losses/plane_depth_row.h"

#include <cmath>
#include <vector>

#include "engine/formulas/plane_depth.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/function_versions.h"

namespace aligngs {
namespace {

// Selections of plain values, not branches: these loops are to be vectorised. Where a pixel has no depth, its numbers
// are replaced by harmless ones.
template <class T>
struct Slope {
  T inverse;     // 1 / s, 0 where there is no depth
  bool clamped;  // s does not depend on the normal
};

template <class T>
ALIGNGS_ALWAYS_INLINE Slope<T> slope_of(T n_x, T n_y, T n_z, T alpha, T distance, T ray_x, T ray_y) {
  const bool covered = (alpha > T(0)) & (distance > T(0));
  const T s = -(n_x * ray_x + n_y * ray_y + n_z);
  const T floor = T(kPlaneSlopeMin) * alpha * std::sqrt(ray_x * ray_x + ray_y * ray_y + T(1));
  const bool clamped = !(s > floor);
  const T used = clamped ? floor : s, safe = covered ? used : T(1);
  return {covered ? T(1) / safe : T(0), clamped};
}

template <class T>
ALIGNGS_ALWAYS_INLINE void depth_row(const PlaneDepthRow<T>& row, T* __restrict depth, T* __restrict level) {
  const T *__restrict n_x = row.n_x, *__restrict n_y = row.n_y, *__restrict n_z = row.n_z;
  const T *__restrict distance = row.distance, *__restrict alpha = row.alpha, *__restrict expected = row.expected;
  const T first_x = row.first_x, step_x = row.step_x, ray_y = row.ray_y;
  for (int x = 0; x < row.width; ++x) {
    const T ray_x = (static_cast<T>(x) + first_x) * step_x;
    const T z = distance[x] * slope_of(n_x[x], n_y[x], n_z[x], alpha[x], distance[x], ray_x, ray_y).inverse;
    const bool solid = (alpha[x] > T(kPlaneAlphaLoss)) & (z > T(0));
    const T mean = expected[x] / (solid ? alpha[x] : T(1));
    const bool tight = solid & (expected[x] > T(0)) & (std::abs(z - mean) <= T(kPlaneExpectedBand) * mean);
    const bool loose = solid & (z > T(0.5) * mean) & (z < T(2) * mean);
    level[x] = tight ? T(kDepthTight) : (loose ? T(kDepthLoose) : T(kDepthInvalid));
    depth[x] = (tight | loose) ? z : T(0);
  }
}

template <class T>
ALIGNGS_ALWAYS_INLINE void chain_row(const PlaneDepthRow<T>& row, const T* __restrict gradient, T* __restrict d_n_x,
                                     T* __restrict d_n_y, T* __restrict d_n_z, T* __restrict d_distance) {
  const T *__restrict n_x = row.n_x, *__restrict n_y = row.n_y, *__restrict n_z = row.n_z;
  const T *__restrict distance = row.distance, *__restrict alpha = row.alpha;
  const T first_x = row.first_x, step_x = row.step_x, ray_y = row.ray_y;
  for (int x = 0; x < row.width; ++x) {
    const T ray_x = (static_cast<T>(x) + first_x) * step_x, g = gradient[x];
    const Slope<T> slope = slope_of(n_x[x], n_y[x], n_z[x], alpha[x], distance[x], ray_x, ray_y);
    const T by_distance = g * slope.inverse;
    const T along = by_distance * distance[x] * slope.inverse;
    // Not finite where the maps are not; such pixels have no gradient.
    const T by_ray = ((g != T(0)) & !slope.clamped) ? along : T(0);
    d_distance[x] += g != T(0) ? by_distance : T(0);
    d_n_x[x] += by_ray * ray_x;
    d_n_y[x] += by_ray * ray_y;
    d_n_z[x] += by_ray;
  }
}

ALIGNGS_FUNCTION_VERSIONS
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

ALIGNGS_FUNCTION_VERSIONS
void chain_plane_depth_row(const PlaneDepthRow<float>& row, const float* gradient, float* d_n_x, float* d_n_y,
                           float* d_n_z, float* d_distance) {
  chain_row<float>(row, gradient, d_n_x, d_n_y, d_n_z, d_distance);
}
void chain_plane_depth_row(const PlaneDepthRow<double>& row, const double* gradient, double* d_n_x, double* d_n_y,
                           double* d_n_z, double* d_distance) {
  chain_row<double>(row, gradient, d_n_x, d_n_y, d_n_z, d_distance);
}

}  // namespace aligngs
