#include "engine/losses/normal_consistency.h"

#include "engine/formulas/normal_terms.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/normal_row.h"
#include "engine/losses/ordered_sum.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

// Fills the input arrays of one row from the depths that its stencils name.
template <class T>
void gather_row(const MapLossWorkspace<T>& workspace, int y, int width, T* in) {
  const size_t begin = static_cast<size_t>(y) * width;
  const auto input = [&](int which, int x) -> T& { return in[static_cast<size_t>(which) * width + x]; };
  for (int x = 0; x < width; ++x) {
    const size_t i = begin + x;
    const DepthStencil stencil = DepthStencil::unpack(workspace.stencil[i]);
    const Reach h = reach_of(stencil.horizontal), v = reach_of(stencil.vertical);
    input(kInRight, x) = workspace.depth[i + h.after];
    input(kInLeft, x) = workspace.depth[i - h.before];
    input(kInTop, x) = workspace.depth[i - static_cast<size_t>(v.before) * width];
    input(kInBottom, x) = workspace.depth[i + static_cast<size_t>(v.after) * width];
    input(kInRightOffset, x) = static_cast<T>(h.after);
    input(kInLeftOffset, x) = static_cast<T>(-h.before);
    input(kInTopOffset, x) = static_cast<T>(-v.before);
    input(kInBottomOffset, x) = static_cast<T>(v.after);
    input(kInUsed, x) = workspace.stencil[i] != 0 ? T(1) : T(0);
  }
}

// Adds the gradients of one row to the normal map and to the depths, those of the rows above and below included.
template <class T>
void scatter_row(const T* out, int y, int width, size_t pixels, MapLossWorkspace<T>& workspace,
                 MapGradients<T>& gradients) {
  const size_t begin = static_cast<size_t>(y) * width;
  const auto output = [&](int which) { return out + static_cast<size_t>(which) * width; };
  for (int c = 0; c < 3; ++c) {
    T* normal = gradients.normal.data() + c * pixels + begin;
    const T* d_normal = output(kOutNormalX + c);
    for (int x = 0; x < width; ++x) normal[x] += d_normal[x];
  }
  for (int x = 0; x < width; ++x) {
    const size_t i = begin + x;
    if (workspace.stencil[i] == 0) continue;
    const DepthStencil stencil = DepthStencil::unpack(workspace.stencil[i]);
    const Reach h = reach_of(stencil.horizontal), v = reach_of(stencil.vertical);
    workspace.depth_gradient[i + h.after] += output(kOutRight)[x];
    workspace.depth_gradient[i - h.before] += output(kOutLeft)[x];
    workspace.depth_gradient[i - static_cast<size_t>(v.before) * width] += output(kOutTop)[x];
    workspace.depth_gradient[i + static_cast<size_t>(v.after) * width] += output(kOutBottom)[x];
  }
}

}  // namespace

template <class T>
double normal_consistency_loss(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace,
                               MapGradients<T>& gradients) {
  const int width = in.maps.width, height = in.maps.height;
  const size_t pixels = in.maps.pixels();
  workspace.stencil.resize(pixels);
  const double count = sum_rows<1>(in.pool, height, workspace.row_sums, [&](int y) {
    double valid = 0;
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      DepthStencil stencil;
      if (workspace.inverse_length[i] > T(0)) {
        stencil = depth_stencil(workspace.depth.data(), workspace.validity.data(), x, y, width, height,
                                in.settings.paper_normals);
      }
      workspace.stencil[i] = stencil.valid() ? stencil.packed() : 0;
      valid += stencil.valid() ? 1 : 0;
    }
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
    gather_row(workspace, y, width, input);
    const NormalRowGeometry<T> geometry{width,        rays.first_x, rays.step_x,
                                        rays(0, y).y, rays.step_y,  static_cast<T>(weight / count)};
    const T* normal = workspace.direction.data() + begin;
    compute_normal_row(geometry, input, normal, normal + pixels, normal + 2 * pixels,
                       workspace.inverse_length.data() + begin, output);
    scatter_row(output, y, width, pixels, workspace, gradients);
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
