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
      const UnitNormal<T> unit = unit_normal_of(blended, in.maps.alpha[i], pixel_counts(in.view, i));
      workspace.inverse_length[i] = unit.inverse_length;
      for (int c = 0; c < 3; ++c) workspace.direction[c * pixels + i] = unit.direction[c];
    }
  });
}

template void compute_unit_normals<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&);
template void compute_unit_normals<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&);

}  // namespace aligngs
