// Kernel of blend_backward.h. One thread per pixel of a tile sweeps from the back and leaves weights and gradients of
// the power of eight Gaussians in shared memory; then one warp per Gaussian adds them up over the pixels. Each sum of
// an instance is formed by one warp in a fixed order, so nothing is added atomically.
//
// The sweep from the back, B_{k-1} = alpha_k v_k + (1 - alpha_k) B_k and dL/dalpha_k = T_k (v_k - B_k), does not cancel
// where T is small (engine/cpu/blend_backward.h). T_k is what is left behind divided by 1 - alpha_k >= 1 - alpha_max.
#pragma once

#include "engine/cuda/blend_backward.h"
#include "engine/cuda/constants.h"
#include "engine/cuda/runtime/device_language.h"
#include "engine/cuda/warp_sums.cuh"
#include "engine/formulas/blending.h"
#include "engine/formulas/whitened.h"

namespace aligngs::cuda {

inline constexpr int kBackwardWarps = kTilePixels / kWarp;
static_assert(kBackwardChunk <= kBackwardWarps, "a Gaussian per warp in the second half");
inline constexpr int kSplatVectors = sizeof(Splat) / sizeof(float4);

/// Shared memory of a block; 35 KB, so that several fit on every architecture.
struct BlendBackwardShared {
  Splat splats[kBackwardChunk];
  float color[3][kTilePixels], normal[3][kTilePixels], distance[kTilePixels], residual[kTilePixels];
  /// Of the Gaussians at hand; the weight's sign bit says that the prior does not support the Gaussian here.
  float weight[kBackwardChunk][kTilePixels], all[kBackwardChunk][kTilePixels], by_color[kBackwardChunk][kTilePixels];
  uint32_t places[kTilePixels];
  int counts[kBackwardWarps];
  uint32_t last[kBackwardWarps];
};

/// What one thread knows of its pixel.
struct BackwardPixel {
  float x = 0, y = 0;  ///< centre
  Vec3<float> ray;
  Vec3<float> color, normal;  ///< dL/dmaps
  float distance = 0, alpha = 0;
  float prior = 0;
  uint32_t last = 0;
  float transmittance = 1;      ///< behind the Gaussian at hand
  float behind_color = 0, behind_all = 0;
};

template <bool kGeometry, bool kDensity>
__device__ BackwardPixel load_backward_pixel(const BlendBackwardInputs& in, int tile, int i, BlendBackwardShared& s) {
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
    s.color[k][i] = px.color[k];
    if (kGeometry) s.normal[k][i] = px.normal[k];
    px.behind_color += in.raster.background[k] * px.color[k];
  }
  if (kGeometry) s.distance[i] = px.distance;
  if (kDensity) s.residual[i] = residual;
  px.behind_all = px.behind_color;
  return px;
}

/// The pixel's share of one Gaussian that some pixel of its strip took.
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

/// One warp: the sums of Gaussian e of the chunk over the strips that took it, field l to lane l.
template <bool kGeometry, bool kDensity>
__device__ __forceinline__ float backward_sums(const BlendBackwardShared& s, int e, unsigned strips, int tile_x,
                                               int tile_y) {
  const int lane = static_cast<int>(threadIdx.x) % kWarp;
  const Splat& g = s.splats[e];
  float v[kWarp] = {};
  WhitenedMoments<float> all;
  for (; strips != 0; strips &= strips - 1) {
    const int i = (__ffs(static_cast<int>(strips)) - 1) * kStripPixels + lane;
    const float signed_weight = s.weight[e][i], w = signed_weight < 0 ? -signed_weight : signed_weight;
    for (int k = 0; k < 3; ++k) v[k] += w * s.color[k][i];
    v[3] += w;
    if (kGeometry) {
      for (int k = 0; k < 3; ++k) v[4 + k] += w * s.normal[k][i];
      v[7] += w * s.distance[i];
    }
    const float dx = static_cast<float>(tile_x * kTileSize + tile_pixel_x(i)) + 0.5f - g.x;
    const float dy = static_cast<float>(tile_y * kTileSize + tile_pixel_y(i)) + 0.5f - g.y;
    const float p = g.fxx * dx + g.fxy * dy, r = g.fyy * dy;
    add_moment(s.all[e][i], p, r, all);
    const float by_color = kGeometry ? s.by_color[e][i] : s.all[e][i];
    v[16] += by_color * p;
    v[17] += by_color * r;
    if (kDensity) {
      v[14] += w * s.residual[i];
      v[15] += signed_weight < 0 ? w : 0.0f;
      v[18] += std::abs(by_color * p);
      v[19] += std::abs(by_color * (g.fxy * p + g.fyy * r));
    }
  }
  v[8] = all.p;
  v[9] = all.r;
  v[10] = all.one;
  v[11] = all.pp;
  v[12] = all.pr;
  v[13] = all.rr;
  return warp_sums(v);
}

template <bool kGeometry, bool kDensity>
__global__ void __launch_bounds__(kTilePixels) blend_backward_kernel(BlendBackwardInputs in,
                                                                     DeviceSpan<SplatGradient> slots) {
  BlendBackwardShared& s = *dynamic_shared<BlendBackwardShared>();
  const int i = static_cast<int>(threadIdx.x), lane = i % kWarp, warp = i / kWarp;
  const int tile = static_cast<int>(blockIdx.x);
  const int tile_x = tile % in.view.tiles_x, tile_y = tile / in.view.tiles_x;
  const uint32_t begin = in.lists.tile_begin[tile];
  BackwardPixel px = load_backward_pixel<kGeometry, kDensity>(in, tile, i, s);
  const uint32_t warp_last = __reduce_max_sync(kFullWarp, px.last);
  if (lane == 0) s.last[warp] = warp_last;
  __syncthreads();
  uint32_t end = 0;
  for (int k = 0; k < kBackwardWarps; ++k) end = s.last[k] > end ? s.last[k] : end;
  while (end > 0) {
    const uint32_t n = end < uint32_t(kTilePixels) ? end : uint32_t(kTilePixels), place = end - 1 - uint32_t(i);
    const bool taken = uint32_t(i) < n && in.record.strips[begin + place] != 0;
    const int count = append(taken, place, s.places, 0, s.counts);
    for (int first = 0; first < count; first += kBackwardChunk) {
      const int chunk = count - first < kBackwardChunk ? count - first : kBackwardChunk;
      if (i < chunk * kSplatVectors) {
        const int e = i / kSplatVectors, part = i % kSplatVectors;
        const Splat* from = &in.view.splats[in.lists.gaussians[begin + s.places[first + e]]];
        reinterpret_cast<float4*>(&s.splats[e])[part] = reinterpret_cast<const float4*>(from)[part];
      }
      __syncthreads();
      for (int e = 0; e < chunk; ++e) {
        const uint32_t at = s.places[first + e];
        if (((in.record.strips[begin + at] >> warp) & 1u) == 0) continue;
        float weight, all, by_color;
        sweep_backward<kGeometry, kDensity>(s.splats[e], at, in.raster, px, weight, all, by_color);
        s.weight[e][i] = weight;
        s.all[e][i] = all;
        if (kGeometry) s.by_color[e][i] = by_color;
      }
      __syncthreads();
      if (warp < chunk) {
        const unsigned strips = in.record.strips[begin + s.places[first + warp]];
        const float sum = backward_sums<kGeometry, kDensity>(s, warp, strips, tile_x, tile_y);
        const size_t slot = static_cast<size_t>(s.splats[warp].slot(tile_x, tile_y));
        if (lane < kSplatGradientFloats) reinterpret_cast<float*>(&slots[slot])[lane] = sum;
      }
      __syncthreads();
    }
    end -= n;
  }
}

}  // namespace aligngs::cuda
