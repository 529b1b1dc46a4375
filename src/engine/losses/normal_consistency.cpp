#include "engine/losses/normal_consistency.h"

#include <algorithm>

#include "engine/formulas/normal_terms.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/depth_stencil_row.h"
#include "engine/losses/normal_row.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {

template <class T>
double normal_consistency_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace,
                               MapGradients<T>& gradients) {
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  workspace.stencil.resize(pixels);
  const StencilMap<T> map{workspace.depth.data(), workspace.validity.data(), width, height};
  const double count = sum_rows<1>(in.pool, height, workspace.row_sums, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * width;
    uint8_t* stencil = workspace.stencil.data() + begin;
    depth_stencil_row(map, y, workspace.inverse_length.data() + begin, in.settings.paper_normals, stencil);
    const double valid = static_cast<double>(width - std::count(stencil, stencil + width, uint8_t(0)));
    return std::array<double, 1>{valid};
  })[0];
  if (!enough_valid(count, static_cast<double>(pixels))) return 0;

  const PixelRays<T> rays(in.view.data.camera);
  workspace.row_sums.assign(static_cast<size_t>(height), 0.0);
  for_each_row_scattering(in.pool, height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * width;
    thread_local std::vector<T> scratch;
    scratch.resize(static_cast<size_t>(kNormalRowInputs + kNormalRowOutputs) * width);
    T *input = scratch.data(), *output = input + static_cast<size_t>(kNormalRowInputs) * width;
    const uint8_t* stencil = workspace.stencil.data() + begin;
    gather_stencil_row(map, y, stencil, input);
    const NormalRowGeometry<T> geometry{width,        rays.first_x, rays.step_x,
                                        rays(0, y).y, rays.step_y,  static_cast<T>(weight / count)};
    const T* normal = workspace.direction.data() + begin;
    compute_normal_row(geometry, input, normal, normal + pixels, normal + 2 * pixels,
                       workspace.inverse_length.data() + begin, output);
    for (int c = 0; c < 3; ++c) {
      T* __restrict d = gradients.normal.data() + c * pixels + begin;
      const T* d_normal = output + static_cast<size_t>(kOutNormalX + c) * width;
      for (int x = 0; x < width; ++x) d[x] += d_normal[x];
    }
    scatter_stencil_row(output + static_cast<size_t>(kOutRight) * width, y, stencil, width, height,
                        workspace.depth_gradient.data());
    workspace.row_sums[static_cast<size_t>(y)] = ordered_sum(output + static_cast<size_t>(kOutLoss) * width, width);
  });
  double total = 0;
  for (const double s : workspace.row_sums) total += s;
  return total / count;
}

template double normal_consistency_loss<float>(const MapLossInputs<float>&, double, MapLossWorkspace<float>&,
                                               MapGradients<float>&);
template double normal_consistency_loss<double>(const MapLossInputs<double>&, double, MapLossWorkspace<double>&,
                                                MapGradients<double>&);

}  // namespace aligngs
