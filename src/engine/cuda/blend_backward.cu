// Kernel of BlendBackwardMethod::kPerPixel. One thread per pixel of a tile sweeps from the back. It leaves weights and
// gradients of the power of eight Gaussians in shared memory. Then one warp per Gaussian adds them up over the pixels.
// Each sum of an instance is formed by one warp in a fixed order, so nothing is added atomically.
#include "engine/cuda/blend_backward.h"

#include "device/launch.h"
#include "engine/cuda/blend_backward_pixel.cuh"

namespace aligngs::cuda {

static_assert(kBackwardChunk <= kBackwardWarps, "a Gaussian per warp in the second half");
inline constexpr int kSplatVectors = sizeof(Splat) / sizeof(float4);

/// Shared memory of a block; 35 KB, so that several fit on every architecture.
struct BlendBackwardShared {
  Splat splats[kBackwardChunk];
  BackwardPixelValues maps;
  /// Values of the current Gaussians, as sweep_backward leaves them.
  float weight[kBackwardChunk][kTilePixels], all[kBackwardChunk][kTilePixels], by_color[kBackwardChunk][kTilePixels];
  uint32_t places[kTilePixels];
  int counts[kBackwardWarps];
  uint32_t last[kBackwardWarps];
};

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
    const float dx = static_cast<float>(tile_x * kTileSize + tile_pixel_x(i)) + 0.5f - g.x;
    const float dy = static_cast<float>(tile_y * kTileSize + tile_pixel_y(i)) + 0.5f - g.y;
    const float by_color = kGeometry ? s.by_color[e][i] : s.all[e][i];
    add_backward_sums<kGeometry, kDensity>(s.maps, i, g, dx, dy, s.weight[e][i], s.all[e][i], by_color, v, all);
  }
  finish_backward_sums(all, v);
  return warp_sums(v);
}

template <bool kGeometry, bool kDensity>
__global__ void __launch_bounds__(kTilePixels)
    blend_backward_kernel(BlendBackwardInputs in, DeviceSpan<SplatGradient> slots) {
  BlendBackwardShared& s = *dynamic_shared<BlendBackwardShared>();
  const int i = static_cast<int>(threadIdx.x), lane = i % kWarp, warp = i / kWarp;
  const int tile = static_cast<int>(blockIdx.x);
  const int tile_x = tile % in.view.tiles_x, tile_y = tile / in.view.tiles_x;
  const uint32_t begin = in.lists.tile_begin[tile];
  BackwardPixel px = load_backward_pixel<kGeometry, kDensity>(in, tile, i, s.maps);
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
namespace {

void by_pixel(const DeviceContext& context, const BlendBackwardInputs& in, DeviceSpan<SplatGradient> slots) {
  const unsigned tiles = static_cast<unsigned>(in.view.tiles_x) * static_cast<unsigned>(in.view.tiles_y);
  const auto with_geometry = in.density ? blend_backward_kernel<true, true> : blend_backward_kernel<true, false>;
  const auto of_color = in.density ? blend_backward_kernel<false, true> : blend_backward_kernel<false, false>;
  const auto kernel = in.geometry ? with_geometry : of_color;
  launch(context, "blend_backward", kernel, {dim3(tiles), dim3(kTilePixels), sizeof(BlendBackwardShared)}, in, slots);
}

}  // namespace

void blend_backward(const DeviceContext& context, const BlendBackwardInputs& in, DeviceSpan<SplatGradient> slots) {
  if (in.method == BlendBackwardMethod::kPerSplat) {
    blend_backward_by_splat(context, in, slots);
  } else {
    by_pixel(context, in, slots);
  }
}

}  // namespace aligngs::cuda
