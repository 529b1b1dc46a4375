#include "engine/losses/normal_row.h"

#include <cmath>
#include <limits>

#include "core/vec.h"
#include "engine/losses/function_versions.h"

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
    const T wanted = in[kInUsed * stride + x];
    const T right_x = ray_x + in[kInRightOffset * stride + x] * step_x;
    const T left_x = ray_x + in[kInLeftOffset * stride + x] * step_x;
    const T top_y = ray_y + in[kInTopOffset * stride + x] * step_y;
    const T bottom_y = ray_y + in[kInBottomOffset * stride + x] * step_y;
    const T right = in[kInRight * stride + x], left = in[kInLeft * stride + x];
    const T top = in[kInTop * stride + x], bottom = in[kInBottom * stride + x];
    const Vec3<T> across{right_x * right - left_x * left, ray_y * (right - left), right - left};
    const Vec3<T> up{ray_x * (top - bottom), top_y * top - bottom_y * bottom, top - bottom};
    const Vec3<T> product = cross(across, up);
    // The points never lie on one line (their rays do not), but their product can leave the range of T.
    const T length = std::sqrt(dot(product, product));
    // Selections of plain values, not branches: this loop is to be vectorised.
    const T measurable = length < std::numeric_limits<T>::max() ? length : T(0);
    const T divisor = measurable > T(0) ? measurable : T(1);
    const T used = measurable > T(0) ? wanted : T(0);
    const T toward = product.x * ray_x + product.y * ray_y + product.z;
    const T inverse = (toward > T(0) ? T(-1) : T(1)) / divisor;
    const Vec3<T> implied{used > T(0) ? product.x * inverse : T(0), used > T(0) ? product.y * inverse : T(0),
                          used > T(0) ? product.z * inverse : T(0)};
    const Vec3<T> blended{n_x[x], n_y[x], n_z[x]};
    const T cosine = dot(implied, blended);
    loss[x] = used * (T(1) - cosine);

    const T factor = -weight * used;  // d(1 - n . m) = -m . dn - n . dm
    const T by_length = factor * inverse_length[x];
    d_n_x[x] = (implied.x - blended.x * cosine) * by_length;
    d_n_y[x] = (implied.y - blended.y * cosine) * by_length;
    d_n_z[x] = (implied.z - blended.z * cosine) * by_length;

    const Vec3<T> d_product = (blended - implied * cosine) * (factor * inverse);
    const Vec3<T> d_across = cross(up, d_product);  // (a x b) . d has the derivatives b x d by a
    const Vec3<T> d_up = cross(d_product, across);  // and d x a by b
    const T d_across_yz = d_across.y * ray_y + d_across.z, d_up_xz = d_up.x * ray_x + d_up.z;
    d_right[x] = d_across.x * right_x + d_across_yz;
    d_left[x] = -(d_across.x * left_x + d_across_yz);
    d_top[x] = d_up.y * top_y + d_up_xz;
    d_bottom[x] = -(d_up.y * bottom_y + d_up_xz);
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

ALIGNGS_FUNCTION_VERSIONS
void compute_normal_row(const NormalRowGeometry<float>& geometry, const float* in, const float* n_x, const float* n_y,
                        const float* n_z, const float* inverse_length, float* out) {
  normal_row<float>(geometry, in, n_x, n_y, n_z, inverse_length, out);
}
void compute_normal_row(const NormalRowGeometry<double>& geometry, const double* in, const double* n_x,
                        const double* n_y, const double* n_z, const double* inverse_length, double* out) {
  normal_row<double>(geometry, in, n_x, n_y, n_z, inverse_length, out);
}

}  // namespace aligngs
