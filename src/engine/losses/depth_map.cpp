#include "engine/losses/depth_map.h"

#include <algorithm>

#include "engine/losses/plane_depth_row.h"
#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

template <class T>
Vec3<T> normal_at(const RenderMaps<T>& maps, size_t pixel) {
  const size_t n = maps.pixels();
  return {maps.normal[pixel], maps.normal[n + pixel], maps.normal[2 * n + pixel]};
}

template <class T>
PlaneDepthRow<T> row_of(const RenderMaps<T>& maps, const PixelRays<T>& rays, int y) {
  const size_t begin = static_cast<size_t>(y) * maps.width, n = maps.pixels();
  const T* normal = maps.normal.data() + begin;
  PlaneDepthRow<T> row;
  row.width = maps.width;
  row.first_x = rays.first_x;
  row.step_x = rays.step_x;
  row.ray_y = rays(0, y).y;
  row.n_x = normal;
  row.n_y = normal + n;
  row.n_z = normal + 2 * n;
  row.distance = maps.distance.data() + begin;
  row.alpha = maps.alpha.data() + begin;
  row.expected = maps.expected.data() + begin;
  return row;
}

}  // namespace

template <class T>
void compute_depth_map(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace) {
  const RenderMaps<T>& maps = in.maps;
  workspace.depth.resize(maps.pixels());
  workspace.validity.resize(maps.pixels());
  workspace.depth_gradient.resize(maps.pixels());
  const PixelRays<T> rays(in.view.data.camera);
  for_each_row(in.pool, maps.height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * maps.width, end = begin + maps.width;
    std::fill(workspace.depth_gradient.begin() + begin, workspace.depth_gradient.begin() + end, T(0));
    if (!in.settings.paper_normals) {
      compute_plane_depth_row(row_of(maps, rays, y), workspace.depth.data() + begin, workspace.validity.data() + begin);
    }
    for (size_t i = begin; i < end; ++i) {
      if (in.settings.paper_normals) {
        const Vec3<T> ray = rays(static_cast<int>(i - begin), y);
        const T z = plane_depth_paper(normal_at(maps, i), maps.distance[i], ray).z;
        const DepthSample<T> sample = judge_depth(z, maps.alpha[i], maps.expected[i]);
        workspace.validity[i] = static_cast<uint8_t>(sample.level);
        workspace.depth[i] = sample.z;
      }
      if (pixel_counts(in.view, i)) continue;
      workspace.validity[i] = kDepthInvalid;
      workspace.depth[i] = T(0);
    }
  });
}

template <class T>
void chain_depth_map(const MapLossInputs<T>& in, const MapLossWorkspace<T>& workspace, MapGradients<T>& gradients) {
  const RenderMaps<T>& maps = in.maps;
  const size_t pixels = maps.pixels();
  const PixelRays<T> rays(in.view.data.camera);
  for_each_row(in.pool, maps.height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * maps.width, end = begin + maps.width;
    T* normal = gradients.normal.data() + begin;
    if (!in.settings.paper_normals) {
      chain_plane_depth_row(row_of(maps, rays, y), workspace.depth_gradient.data() + begin, normal, normal + pixels,
                            normal + 2 * pixels, gradients.distance.data() + begin);
      return;
    }
    for (size_t i = begin; i < end; ++i) {
      const T g = workspace.depth_gradient[i];
      if (g == T(0)) continue;
      const Vec3<T> ray = rays(static_cast<int>(i - begin), y);
      const PlaneDepth<T> d = plane_depth_paper(normal_at(maps, i), maps.distance[i], ray);
      gradients.distance[i] += g * d.dz_ddistance;
      gradients.normal[i] += g * d.dz_dnormal.x;
      gradients.normal[pixels + i] += g * d.dz_dnormal.y;
      gradients.normal[2 * pixels + i] += g * d.dz_dnormal.z;
    }
  });
}

template void compute_depth_map<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&);
template void compute_depth_map<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&);
template void chain_depth_map<float>(const MapLossInputs<float>&, const MapLossWorkspace<float>&, MapGradients<float>&);
template void chain_depth_map<double>(const MapLossInputs<double>&, const MapLossWorkspace<double>&,
                                      MapGradients<double>&);

}  // namespace aligngs
