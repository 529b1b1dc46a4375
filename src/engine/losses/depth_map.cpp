#include "engine/losses/depth_map.h"

#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

template <class T>
Vec3<T> normal_at(const RenderMaps<T>& maps, size_t pixel) {
  const size_t n = maps.pixels();
  return {maps.normal[pixel], maps.normal[n + pixel], maps.normal[2 * n + pixel]};
}

template <class T>
PlaneDepth<T> depth_at(const MapLossInputs<T>& in, size_t pixel, const Vec3<T>& ray) {
  const Vec3<T> normal = normal_at(in.maps, pixel);
  return in.settings.paper_normals ? plane_depth_paper(normal, in.maps.distance[pixel], ray)
                                   : plane_depth(normal, in.maps.distance[pixel], in.maps.alpha[pixel], ray);
}

template <class T>
DepthValidity validity_of(T z, T alpha, T expected) {
  if (plane_depth_valid(z, alpha, expected, T(kPlaneAlphaLoss))) return kDepthTight;
  if (!(alpha > T(kPlaneAlphaLoss)) || !(z > T(0))) return kDepthInvalid;
  const T mean = expected / alpha;
  return z > T(0.5) * mean && z < T(2) * mean ? kDepthLoose : kDepthInvalid;
}

}  // namespace

template <class T>
void compute_depth_map(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace) {
  const RenderMaps<T>& maps = in.maps;
  workspace.depth.resize(maps.pixels());
  workspace.validity.resize(maps.pixels());
  workspace.depth_gradient.assign(maps.pixels(), T(0));
  const PixelRays<T> rays(in.view.data.camera);
  for_each_row(in.pool, maps.height, [&](int y) {
    for (int x = 0; x < maps.width; ++x) {
      const size_t i = static_cast<size_t>(y) * maps.width + x;
      const T z = depth_at(in, i, rays(x, y)).z;
      const DepthValidity validity =
          pixel_counts(in.view, i) ? validity_of(z, maps.alpha[i], maps.expected[i]) : kDepthInvalid;
      workspace.validity[i] = validity;
      workspace.depth[i] = validity == kDepthInvalid ? T(0) : z;
    }
  });
}

template <class T>
void chain_depth_map(const MapLossInputs<T>& in, const MapLossWorkspace<T>& workspace, MapGradients<T>& gradients) {
  const RenderMaps<T>& maps = in.maps;
  const size_t pixels = maps.pixels();
  const PixelRays<T> rays(in.view.data.camera);
  for_each_row(in.pool, maps.height, [&](int y) {
    for (int x = 0; x < maps.width; ++x) {
      const size_t i = static_cast<size_t>(y) * maps.width + x;
      const T g = workspace.depth_gradient[i];
      if (g == T(0)) continue;
      const PlaneDepth<T> d = depth_at(in, i, rays(x, y));
      gradients.distance[i] += g * d.dz_ddistance;
      gradients.normal[i] += g * d.dz_dnormal.x;
      gradients.normal[pixels + i] += g * d.dz_dnormal.y;
      gradients.normal[2 * pixels + i] += g * d.dz_dnormal.z;
    }
  });
}

template void compute_depth_map<float>(const MapLossInputs<float>&, MapLossWorkspace<float>&);
template void compute_depth_map<double>(const MapLossInputs<double>&, MapLossWorkspace<double>&);
template void chain_depth_map<float>(const MapLossInputs<float>&, const MapLossWorkspace<float>&,
                                     MapGradients<float>&);
template void chain_depth_map<double>(const MapLossInputs<double>&, const MapLossWorkspace<double>&,
                                      MapGradients<double>&);

}  // namespace aligngs
