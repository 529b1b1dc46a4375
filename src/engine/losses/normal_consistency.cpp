#include "engine/losses/normal_consistency.h"

#include "engine/losses/depth_normal.h"
#include "engine/losses/row_parallel.h"
#include "engine/losses/unit_normal.h"

namespace aligngs {

template <class T>
double normal_consistency_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace,
                               MapGradients<T>& gradients) {
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  const PixelRays<T> rays(in.view.data.camera);
  workspace.stencil.resize(pixels);
  const double count = sum_rows<1>(in.pool, height, workspace.row_sums, [&](int y) {
    double valid = 0;
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      DepthStencil stencil;
      if (workspace.inverse_length[i] > T(0)) {
        stencil = depth_stencil(workspace, x, y, width, height, in.settings.paper_normals);
      }
      workspace.stencil[i] = stencil.valid() ? stencil.packed() : 0;
      valid += stencil.valid() ? 1 : 0;
    }
    return std::array<double, 1>{valid};
  })[0];
  if (count < 1 || count < kMinimumValidShare * static_cast<double>(pixels)) return 0;

  const T step = static_cast<T>(-weight / count);
  std::vector<double>& row_loss = workspace.row_sums;
  row_loss.assign(static_cast<size_t>(height), 0.0);
  for_each_row_scattering(in.pool, height, [&](int y) {
    double sum = 0;
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      if (workspace.stencil[i] == 0) continue;
      const UnitNormal<T> blended = unit_normal_at(workspace, i);
      const DepthNormal<T> implied =
          depth_normal(workspace, rays, x, y, width, DepthStencil::unpack(workspace.stencil[i]));
      if (!implied.valid()) continue;
      sum += 1 - static_cast<double>(dot(blended.direction, implied.direction));
      add_normal_gradient(blended, implied.direction * step, i, pixels, gradients);
      add_depth_normal_gradient(implied, blended.direction * step, workspace);
    }
    row_loss[static_cast<size_t>(y)] = sum;
  });
  double total = 0;
  for (const double s : row_loss) total += s;
  return total / count;
}

template double normal_consistency_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&,
                                               MapGradients<float>&);
template double normal_consistency_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&,
                                                MapGradients<double>&);

}  // namespace aligngs
