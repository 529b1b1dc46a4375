// Kernel of blend_forward.h: one thread per pixel of a tile, a batch of its Gaussians at a time in shared memory. A
// warp is a strip of 8 x 4 pixels and skips Gaussians that do not reach it.
#include "engine/cuda/blend_forward.h"

#include "device/launch.h"
#include "engine/cuda/tile_batch.cuh"
#include "engine/formulas/blending.h"
#include "engine/formulas/whitened.h"

namespace aligngs::cuda {

template <bool kGeometry>
struct BlendedPixel {
  float color[3] = {}, alpha = 0, normal[3] = {}, distance = 0, expected = 0, median = 0;

  __device__ __forceinline__ void add(const Splat& g, float weight, float before, float after, const Vec3<float>& ray) {
    for (int k = 0; k < 3; ++k) color[k] = std::fma(weight, g.color[k], color[k]);
    alpha += weight;
    if constexpr (kGeometry) {
      for (int k = 0; k < 3; ++k) normal[k] = std::fma(weight, g.normal[k], normal[k]);
      distance = std::fma(weight, g.distance, distance);
      const float z = intersection_depth(plane_of(g), ray);
      expected = std::fma(weight, z, expected);
      if (before >= float(kMedianTransmittance) && after < float(kMedianTransmittance)) median = z;
    }
  }
};

/// This thread's pixel in front of `place` of the list that begins at `begin`.
template <bool kGeometry>
__device__ __forceinline__ void store_checkpoint(const BlendRecordSpans& record, uint32_t begin, uint32_t place,
                                                 float transmittance, const BlendedPixel<kGeometry>& sums) {
  const size_t at = checkpoint_index(begin, place) * kTilePixels + threadIdx.x;
  record.checkpoints[at] = {transmittance, {sums.color[0], sums.color[1], sums.color[2]}};
  if constexpr (kGeometry) {
    record.plane_checkpoints[at] = {{sums.normal[0], sums.normal[1], sums.normal[2]}, sums.distance};
  }
}

template <bool kGeometry>
__global__ void __launch_bounds__(kTilePixels)
    blend_tiles(BlendForwardInputs in, RenderMapSpans maps, BlendRecordSpans record) {
  static_assert(kBlendBatch == kTilePixels, "one Gaussian per thread and batch");
  static_assert(kBlendBatch % kCheckpointPlaces == 0 && kCheckpointPlaces == 32, "a checkpoint per group of a warp");
  __shared__ TileBatch batch;
  __shared__ uint32_t taken_by[kBlendBatch];
  const ViewSpans& view = in.view;
  const int tile_x = static_cast<int>(blockIdx.x), tile_y = static_cast<int>(blockIdx.y);
  const uint32_t tile = blockIdx.y * gridDim.x + blockIdx.x;
  const int left = tile_x * kTileSize, top = tile_y * kTileSize;
  const int pixel = static_cast<int>(threadIdx.x), strip = static_cast<int>(warp_index());
  const int x = left + tile_pixel_x(pixel), y = top + tile_pixel_y(pixel);
  const bool inside = x < view.width && y < view.height;
  const float pixel_x = static_cast<float>(x) + 0.5f, pixel_y = static_cast<float>(y) + 0.5f;
  const Vec3<float> ray = view.camera.ray(x, y);
  const uint32_t begin = in.lists.tile_begin[tile], end = in.lists.tile_begin[tile + 1];

  PixelBlend blend;
  blend.open = inside;
  BlendedPixel<kGeometry> sums;
  uint32_t last = 0;
  const bool keep = !record.last.empty();
  uint32_t first = begin;
  for (; first < end; first += kBlendBatch) {
    if (__syncthreads_count(blend.open) == 0) break;  // also: the batch before is read
    const uint32_t count = std::min<uint32_t>(kBlendBatch, end - first);
    load_batch(view, in.lists, first, count, left, top, batch);
    taken_by[threadIdx.x] = 0;
    __syncthreads();
    bool some_open = __any_sync(kFullWarp, blend.open) != 0;
    for (uint32_t group = 0; group < count && some_open; group += 32) {
      const uint32_t mine = group + lane_index(), place = first - begin + group;
      if (place > 0 && !record.checkpoints.empty()) {
        store_checkpoint<kGeometry>(record, begin, place, blend.transmittance, sums);
      }
      const bool reaches = mine < count && (batch.strips[mine] >> strip & 1u) != 0;
      for (unsigned hits = __ballot_sync(kFullWarp, reaches); hits != 0 && some_open; hits &= hits - 1) {
        const uint32_t k = group + static_cast<uint32_t>(__ffs(static_cast<int>(hits)) - 1);
        const Splat& g = batch.splats[k];
        const WhitenedAlpha a = whitened_alpha(g, pixel_x, pixel_y, in.raster);
        const float before = blend.transmittance;
        float weight = 0;
        const bool takes = blend.take(a.alpha, a.wanted, in.raster.transmittance_min, weight);
        if (takes) {
          sums.add(g, weight, before, blend.transmittance, ray);
          last = first - begin + k + 1;
        }
        if (keep && __any_sync(kFullWarp, takes) != 0 && lane_index() == 0) atomicOr(&taken_by[k], 1u << strip);
        some_open = __any_sync(kFullWarp, blend.open) != 0;
      }
    }
    if (!keep) continue;
    __syncthreads();
    if (threadIdx.x < count) {
      const uint32_t strips = taken_by[threadIdx.x];
      record.strips[first + threadIdx.x] = static_cast<uint8_t>(strips);
      record.seen[static_cast<size_t>(batch.splats[threadIdx.x].slot(tile_x, tile_y))] = strips != 0;
    }
  }
  if (keep) {
    // No pixel takes a Gaussian behind the last batch.
    for (uint32_t at = first + threadIdx.x; at < end; at += kTilePixels) {
      record.strips[at] = 0;
      record.seen[static_cast<size_t>(view.splats[in.lists.gaussians[at]].slot(tile_x, tile_y))] = 0;
    }
    record.last[size_t(tile) * kTilePixels + threadIdx.x] = last;
    record.transmittance[size_t(tile) * kTilePixels + threadIdx.x] = blend.transmittance;
  }
  if (!inside) return;
  const size_t n = size_t(view.width) * static_cast<size_t>(view.height);
  const size_t u = static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x);
  for (size_t k = 0; k < 3; ++k) {
    maps.color[k * n + u] = std::fma(blend.transmittance, in.raster.background[k], sums.color[k]);
  }
  maps.alpha[u] = sums.alpha;
  if constexpr (kGeometry) {
    for (size_t k = 0; k < 3; ++k) maps.normal[k * n + u] = sums.normal[k];
    maps.distance[u] = sums.distance;
    maps.expected[u] = sums.expected;
    maps.median[u] = sums.median;
  }
}

void blend_forward(const DeviceContext& context, const BlendForwardInputs& in, const RenderMapSpans& maps,
                   const BlendRecordSpans& record) {
  const LaunchShape shape{dim3(static_cast<unsigned>(in.view.tiles_x), static_cast<unsigned>(in.view.tiles_y)),
                          dim3(kTilePixels), 0};
  launch(context, "blend_tiles", in.geometry ? blend_tiles<true> : blend_tiles<false>, shape, in, maps, record);
}

}  // namespace aligngs::cuda
