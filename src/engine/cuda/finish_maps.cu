// Kernel of finish_maps.h: one thread per pixel.
#include "engine/cuda/finish_maps.h"

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"
#include "engine/formulas/plane_depth.h"

namespace aligngs::cuda {

__global__ void __launch_bounds__(kRowThreads) finish_pixels(ViewSpans view, RenderMapSpans m, FinishedMaps out) {
  const size_t u = item_index(), n = m.alpha.size;
  if (u >= n) return;
  for (size_t k = 0; k < 3; ++k) out.color[3 * u + k] = m.color[k * n + u];
  if (out.normal.empty()) return;
  const int x = static_cast<int>(u % static_cast<size_t>(m.width)),
            y = static_cast<int>(u / static_cast<size_t>(m.width));
  const Vec3<float> sum{m.normal[u], m.normal[n + u], m.normal[2 * n + u]};
  const Vec3<float> unit = normalized(sum);
  for (int k = 0; k < 3; ++k) out.normal[3 * u + static_cast<size_t>(k)] = unit[k];
  const float alpha = m.alpha[u];
  const float z = plane_depth(sum, m.distance[u], alpha, view.camera.ray(x, y)).z;
  const bool valid = plane_depth_valid(z, alpha, m.expected[u], float(kPlaneAlphaLoss));
  out.depth_plane[u] = valid ? z : 0.0f;
  out.depth_expected[u] = alpha > 0 ? m.expected[u] / alpha : 0.0f;
}

void finish_maps(const DeviceContext& context, const ViewSpans& view, const RenderMapSpans& maps,
                 const FinishedMaps& out) {
  launch(context, "finish_pixels", finish_pixels, one_per_item(maps.alpha.size, kRowThreads), view, maps, out);
}

}  // namespace aligngs::cuda
