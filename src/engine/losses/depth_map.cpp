#include "engine/losses/depth_map.h"

#include <cmath>

#include "engine/losses/row_parallel.h"

namespace aligngs {
namespace {

constexpr double kGrazingShare = 0.1;     // s is at least this share of A |r| (guidance 2.5)
constexpr double kPaperEpsilon = 1e-8;    // added to -N.r in the formula as printed

// z = D / s with s = -N.r, r the ray with z = 1; `slides` is false where s is clamped and so constant.
template <class T>
struct PlaneDepth {
  T z = 0, s = 0;
  bool slides = true;
};

template <class T>
PlaneDepth<T> plane_depth(const Vec3<T>& normal, T distance, T alpha, const Vec3<T>& ray, bool as_printed) {
  PlaneDepth<T> result;
  result.s = -dot(normal, ray);
  if (as_printed) {
    result.s += T(kPaperEpsilon);
  } else {
    const T least = T(kGrazingShare) * alpha * norm(ray);
    if (!(result.s > least)) {
      result.s = least;
      result.slides = false;
    }
  }
  result.z = result.s != T(0) ? distance / result.s : T(0);
  return result;
}

template <class T>
Vec3<T> normal_at(const RenderMaps<T>& maps, size_t pixel) {
  const size_t n = maps.pixels();
  return {maps.normal[pixel], maps.normal[n + pixel], maps.normal[2 * n + pixel]};
}

template <class T>
DepthValidity validity_of(T z, T alpha, T expected) {
  if (!(alpha > T(kAlphaSurface)) || !(z > T(0)) || !std::isfinite(z)) return kDepthInvalid;
  const T mean = expected / alpha;
  if (std::abs(z - mean) <= T(kDepthTightShare) * mean) return kDepthTight;
  return z > T(0.5) * mean && z < T(2) * mean ? kDepthLoose : kDepthInvalid;
}

}  // namespace

template <class T>
void compute_depth_map(const MapLossInputs<T>& in, MapLossWorkspace<T>& workspace) {
  const RenderMaps<T>& maps = in.maps;
  workspace.depth.resize(maps.pixels());
  workspace.validity.resize(maps.pixels());
  workspace.depth_gradient.assign(maps.pixels(), T(0));
  for_each_row(in.pool, maps.height, [&](int y) {
    for (int x = 0; x < maps.width; ++x) {
      const size_t i = static_cast<size_t>(y) * maps.width + x;
      const PlaneDepth<T> d = plane_depth(normal_at(maps, i), maps.distance[i], maps.alpha[i],
                                          pixel_ray<T>(in.view.data.camera, x, y), in.settings.paper_normals);
      const DepthValidity validity =
          pixel_counts(in.view, i) ? validity_of(d.z, maps.alpha[i], maps.expected[i]) : kDepthInvalid;
      workspace.validity[i] = validity;
      workspace.depth[i] = validity == kDepthInvalid ? T(0) : d.z;
    }
  });
}

template <class T>
void chain_depth_map(const MapLossInputs<T>& in, const MapLossWorkspace<T>& workspace, MapGradients<T>& gradients) {
  const RenderMaps<T>& maps = in.maps;
  const size_t pixels = maps.pixels();
  for_each_row(in.pool, maps.height, [&](int y) {
    for (int x = 0; x < maps.width; ++x) {
      const size_t i = static_cast<size_t>(y) * maps.width + x;
      const T g = workspace.depth_gradient[i];
      if (g == T(0)) continue;
      const Vec3<T> ray = pixel_ray<T>(in.view.data.camera, x, y);
      const PlaneDepth<T> d =
          plane_depth(normal_at(maps, i), maps.distance[i], maps.alpha[i], ray, in.settings.paper_normals);
      gradients.distance[i] += g / d.s;
      if (!d.slides) continue;
      const T along = g * d.z / d.s;  // dz / dN = D r / s^2
      gradients.normal[i] += along * ray.x;
      gradients.normal[pixels + i] += along * ray.y;
      gradients.normal[2 * pixels + i] += along * ray.z;
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
