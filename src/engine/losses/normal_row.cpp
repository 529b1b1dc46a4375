#include "engine/losses/normal_row.h"

#include "core/target_clones.h"
#include "engine/formulas/normal_terms.h"

namespace aligngs {
namespace {

template <class T>
ALIGNGS_ALWAYS_INLINE void normal_row(const NormalRowGeometry<T>& geometry, const T* __restrict in,
                                      const T* __restrict n_x, const T* __restrict n_y, const T* __restrict n_z,
                                      const T* __restrict inverse_length, T* __restrict loss, T* __restrict d_n_x,
                                      T* __restrict d_n_y, T* __restrict d_n_z, T* __restrict d_right,
                                      T* __restrict d_left, T* __restrict d_top, T* __restrict d_bottom) {
  const int width = geometry.width;
  const T first_x = geometry.first_x, step_x = geometry.step_x, ray_y = geometry.ray_y, step_y = geometry.step_y;
  const T weight = geometry.weight;
  const size_t stride = static_cast<size_t>(width);
  for (int x = 0; x < width; ++x) {
    const T ray_x = (static_cast<T>(x) + first_x) * step_x;
    const DepthNeighbours<T> neighbours{
        in[kInRight * stride + x],     in[kInLeft * stride + x],         in[kInTop * stride + x],
        in[kInBottom * stride + x],    in[kInRightOffset * stride + x],  in[kInLeftOffset * stride + x],
        in[kInTopOffset * stride + x], in[kInBottomOffset * stride + x], in[kInUsed * stride + x]};
    const NormalComparison<T> c =
        compare_normals(neighbours, ray_x, ray_y, step_x, step_y, {n_x[x], n_y[x], n_z[x]}, inverse_length[x], weight);
    loss[x] = c.loss;
    d_n_x[x] = c.d_x;
    d_n_y[x] = c.d_y;
    d_n_z[x] = c.d_z;
    d_right[x] = c.d_right;
    d_left[x] = c.d_left;
    d_top[x] = c.d_top;
    d_bottom[x] = c.d_bottom;
  }
}

// One pointer per output array, so that the compiler knows them to be apart.
template <class T>
ALIGNGS_ALWAYS_INLINE void normal_row(const NormalRowGeometry<T>& geometry, const T* in, const T* n_x, const T* n_y,
                                      const T* n_z, const T* inverse_length, T* out) {
  const size_t stride = static_cast<size_t>(geometry.width);
  normal_row<T>(geometry, in, n_x, n_y, n_z, inverse_length, out + kOutLoss * stride, out + kOutNormalX * stride,
                out + kOutNormalY * stride, out + kOutNormalZ * stride, out + kOutRight * stride,
                out + kOutLeft * stride, out + kOutTop * stride, out + kOutBottom * stride);
}

}  // namespace

ALIGNGS_TARGET_CLONES
void compute_normal_row(const NormalRowGeometry<float>& geometry, const float* in, const float* n_x, const float* n_y,
                        const float* n_z, const float* inverse_length, float* out) {
  normal_row<float>(geometry, in, n_x, n_y, n_z, inverse_length, out);
}
void compute_normal_row(const NormalRowGeometry<double>& geometry, const double* in, const double* n_x,
                        const double* n_y, const double* n_z, const double* inverse_length, double* out) {
  normal_row<double>(geometry, in, n_x, n_y, n_z, inverse_length, out);
}

}  // namespace aligngs
