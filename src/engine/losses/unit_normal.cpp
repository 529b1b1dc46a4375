#include "engine/losses/unit_normal.h"

#include "core/target_clones.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

// One row of the blended normals.
template <class T>
struct BlendedNormalRow {
  const T *n_x, *n_y, *n_z, *alpha;
  const float* mask;  // nullptr = every pixel counts
  int width;
};

template <bool kMasked, class T>
ALIGNGS_ALWAYS_INLINE void normalise_row(const BlendedNormalRow<T>& row, T* __restrict x_out, T* __restrict y_out,
                                         T* __restrict z_out, T* __restrict inverse_length) {
  const T* __restrict n_x = row.n_x;
  const T* __restrict n_y = row.n_y;
  const T* __restrict n_z = row.n_z;
  const T* __restrict alpha = row.alpha;
  const float* __restrict mask = row.mask;
  for (int x = 0; x < row.width; ++x) {
    const bool counts = kMasked ? mask[x] > 0.5f : true;
    const UnitNormal<T> unit = unit_normal_of<T>({n_x[x], n_y[x], n_z[x]}, alpha[x], counts);
    x_out[x] = unit.direction.x;
    y_out[x] = unit.direction.y;
    z_out[x] = unit.direction.z;
    inverse_length[x] = unit.inverse_length;
  }
}

template <class T>
ALIGNGS_ALWAYS_INLINE void normalise_either(const BlendedNormalRow<T>& row, T* x, T* y, T* z, T* inverse_length) {
  if (row.mask == nullptr) {
    normalise_row<false>(row, x, y, z, inverse_length);
  } else {
    normalise_row<true>(row, x, y, z, inverse_length);
  }
}

// Compiled per instruction set: function versions cannot be templates.
ALIGNGS_TARGET_CLONES
void normalise(const BlendedNormalRow<float>& row, float* x, float* y, float* z, float* inverse_length) {
  normalise_either(row, x, y, z, inverse_length);
}
void normalise(const BlendedNormalRow<double>& row, double* x, double* y, double* z, double* inverse_length) {
  normalise_either(row, x, y, z, inverse_length);
}

}  // namespace

template <class T>
void compute_unit_normals(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace) {
  const size_t pixels = in.maps.pixels();
  const ImageF& mask = in.view.data.mask;
  workspace.direction.resize(3 * pixels);
  workspace.inverse_length.resize(pixels);
  for_each_row(in.pool, in.maps.height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * in.maps.width;
    const T* n = in.maps.normal.data() + begin;
    T* direction = workspace.direction.data() + begin;
    normalise(BlendedNormalRow<T>{n, n + pixels, n + 2 * pixels, in.maps.alpha.data() + begin,
                                  mask.empty() ? nullptr : mask.data.data() + begin, in.maps.width},
              direction, direction + pixels, direction + 2 * pixels, workspace.inverse_length.data() + begin);
  });
}

template void compute_unit_normals<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&);
template void compute_unit_normals<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&);

}  // namespace aligngs
