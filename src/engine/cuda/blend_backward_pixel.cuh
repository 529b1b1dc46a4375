// The work of both kernels of blend_backward.h at one pixel with one Gaussian.
//
// The sweep from the back, B_{k-1} = alpha_k v_k + (1 - alpha_k) B_k and dL/dalpha_k = T_k (v_k - B_k), does not cancel
// where T is small (engine/cpu/blend_backward.h). T_k is what is left behind divided by 1 - alpha_k >= 1 - alpha_max.
#pragma once

#include "device/constants.h"
#include "device/device_language.h"
#include "engine/cuda/blend_backward.h"
#include "engine/cuda/warp_sums.cuh"
#include "engine/formulas/blending.h"
#include "engine/formulas/whitened.h"

namespace aligngs::cuda {

inline constexpr int kBackwardWarps = kTilePixels / kWarp;

/// Values of a tile's pixels, in shared memory: the sums multiply weights with them.
struct BackwardPixelValues {
  float color[3][kTilePixels], normal[3][kTilePixels], distance[kTilePixels], residual[kTilePixels];
};

/// The state of one thread's pixel.
struct BackwardPixel {
  float x = 0, y = 0;  ///< centre
  Vec3<float> ray;
  Vec3<float> color, normal;  ///< dL/dmaps
  float distance = 0, alpha = 0;
  float prior = 0;
  uint32_t last = 0;
  float transmittance = 1;  ///< behind the current Gaussian
  float behind_color = 0, behind_all = 0;
};

/// Pixel i of the tile, and its share of `maps`.
template <bool kGeometry, bool kDensity>
__device__ __forceinline__ BackwardPixel load_backward_pixel(const BlendBackwardInputs& in, int tile, int i,
                                                             BackwardPixelValues& maps) {
  BackwardPixel px;
  const int x = tile % in.view.tiles_x * kTileSize + tile_pixel_x(i);
  const int y = tile / in.view.tiles_x * kTileSize + tile_pixel_y(i);
  px.x = static_cast<float>(x) + 0.5f;
  px.y = static_cast<float>(y) + 0.5f;
  float residual = 0;
  if (x < in.view.width && y < in.view.height) {
    const size_t n = size_t(in.view.width) * in.view.height, u = size_t(y) * in.view.width + x;
    px.color = {in.gradients.color[u], in.gradients.color[n + u], in.gradients.color[2 * n + u]};
    if (kGeometry) {
      px.normal = {in.gradients.normal[u], in.gradients.normal[n + u], in.gradients.normal[2 * n + u]};
      px.distance = in.gradients.distance[u];
      px.alpha = in.gradients.alpha[u];
    }
    if (kDensity) {
      residual = in.residual[u];
      px.ray = in.view.camera.ray(x, y);
      if (!in.prior.empty()) px.prior = in.prior[u] * in.prior_scale;
    }
    px.last = in.record.last[size_t(tile) * kTilePixels + i];
    px.transmittance = in.record.transmittance[size_t(tile) * kTilePixels + i];
  }
  for (int k = 0; k < 3; ++k) {
    maps.color[k][i] = px.color[k];
    if (kGeometry) maps.normal[k][i] = px.normal[k];
    px.behind_color += in.raster.background[k] * px.color[k];
  }
  if (kGeometry) maps.distance[i] = px.distance;
  if (kDensity) maps.residual[i] = residual;
  px.behind_all = px.behind_color;
  return px;
}

/// The pixel's share of one Gaussian that some pixel of its strip took: its weight, and dL/dpower by all losses and by
/// colour alone. The weight's sign bit marks a Gaussian that the prior does not support here.
template <bool kGeometry, bool kDensity>
__device__ __forceinline__ void sweep_backward(const Splat& g, uint32_t place, const RasterSettings& raster,
                                               BackwardPixel& px, float& weight, float& all, float& by_color) {
  const WhitenedAlpha a = whitened_alpha(g, px.x, px.y, raster);
  weight = all = by_color = 0;
  if (!a.wanted || place >= px.last) return;
  const float before = px.transmittance / (1 - a.alpha);
  weight = a.alpha * before;
  float v = g.color[0] * px.color.x + g.color[1] * px.color.y + g.color[2] * px.color.z;
  const float slope = a.slope * before, color_step = v - px.behind_color;
  px.behind_color += a.alpha * color_step;
  by_color = all = slope * color_step;
  if (kGeometry) {
    v += g.normal[0] * px.normal.x + g.normal[1] * px.normal.y + g.normal[2] * px.normal.z;
    v += g.distance * px.distance + px.alpha;
    const float step = v - px.behind_all;
    px.behind_all += a.alpha * step;
    all = slope * step;
  }
  px.transmittance = before;
  if (kDensity) {
    if (prior_unsupported(px.prior, intersection_depth(plane_of(g), px.ray))) weight = -weight;
  }
}

/// Adds pixel i to the sums of a Gaussian whose mean lies (dx, dy) from its centre. `v` has the fields of SplatGradient
/// except the moments of all losses, which finish_backward_sums writes.
template <bool kGeometry, bool kDensity, int kCount>
__device__ __forceinline__ void add_backward_sums(const BackwardPixelValues& maps, int i, const Splat& g, float dx,
                                                  float dy, float signed_weight, float all, float by_color,
                                                  float (&v)[kCount], WhitenedMoments<float>& moments) {
  const float w = signed_weight < 0 ? -signed_weight : signed_weight;
  for (int k = 0; k < 3; ++k) v[kSumColor + k] += w * maps.color[k][i];
  v[kSumWeight] += w;
  if (kGeometry) {
    for (int k = 0; k < 3; ++k) v[kSumNormal + k] += w * maps.normal[k][i];
    v[kSumDistance] += w * maps.distance[i];
  }
  const float p = g.fxx * dx + g.fxy * dy, r = g.fyy * dy;
  add_moment(all, p, r, moments);
  v[kSumPhotometricP] += by_color * p;
  v[kSumPhotometricR] += by_color * r;
  if (kDensity) {
    v[kSumResidual] += w * maps.residual[i];
    v[kSumUnsupported] += signed_weight < 0 ? w : 0.0f;
    v[kSumPhotometricAbsP] += std::abs(by_color * p);
    v[kSumPhotometricAbsY] += std::abs(by_color * (g.fxy * p + g.fyy * r));
  }
}

template <int kCount>
__device__ __forceinline__ void finish_backward_sums(const WhitenedMoments<float>& moments, float (&v)[kCount]) {
  static_assert(kCount >= kSplatGradientFloats);
  v[kSumP] = moments.p;
  v[kSumR] = moments.r;
  v[kSumOne] = moments.one;
  v[kSumPp] = moments.pp;
  v[kSumPr] = moments.pr;
  v[kSumRr] = moments.rr;
}

}  // namespace aligngs::cuda
