#include "engine/losses/unit_normal.h"

#include "engine/losses/row_parallel.h"

namespace aligngs {

template <class T>
void compute_unit_normals(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace) {
  const size_t pixels = in.maps.pixels();
  workspace.direction.resize(3 * pixels);
  workspace.inverse_length.resize(pixels);
  for_each_row(in.pool, in.maps.height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * in.maps.width;
    for (size_t i = begin; i < begin + in.maps.width; ++i) {
      const Vec3<T> blended{in.maps.normal[i], in.maps.normal[pixels + i], in.maps.normal[2 * pixels + i]};
      const T alpha = in.maps.alpha[i], length = norm(blended);
      const bool valid = alpha > T(kPlaneAlphaLoss) && length > T(kNormalCoherence) * alpha &&
                         std::isfinite(length) && pixel_counts(in.view, i);
      const T inverse = valid ? T(1) / length : T(0);
      workspace.inverse_length[i] = inverse;
      for (int c = 0; c < 3; ++c) workspace.direction[c * pixels + i] = valid ? blended[c] * inverse : T(0);
    }
  });
}

template void compute_unit_normals<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&);
template void compute_unit_normals<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&);

}  // namespace aligngs
