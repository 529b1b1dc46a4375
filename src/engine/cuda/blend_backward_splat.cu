// Kernel of BlendBackwardMethod::kPerSplat: a warp has 32 neighbours of a tile's list, a lane each, and the pixels pass
// by. A pixel enters at the farthest Gaussian, with the forward pass's checkpoint behind it. It moves a lane nearer at
// each step. A lane adds up for its Gaussian alone, so the sums over pixels need neither shuffles nor shared memory.
// The idea is that of Mallick et al. 2024 (Taming 3DGS, section 4.2). There pixels enter from the front. Here they
// enter from the back, because that sweep does not cancel (blend_backward_pixel.cuh).
#include <algorithm>

#include "core/error.h"
#include "device/launch.h"
#include "engine/cuda/blend_backward.h"
#include "engine/cuda/blend_backward_pixel.cuh"

namespace aligngs::cuda {

static_assert(kCheckpointPlaces == kWarp && kStripPixels == kWarp, "a lane per Gaussian and per pixel of a strip");

/// Shared memory of a block, [pixel of the tile]; 17 KB.
struct SplatBackwardShared {
  BackwardPixelValues maps;
  float alpha[kTilePixels];                                          ///< dL/dalpha map, with geometry
  float prior[kTilePixels], ray_x[kTilePixels], ray_y[kTilePixels];  ///< with density
  float transmittance[kTilePixels];                                  ///< behind the last Gaussian
  float background[kTilePixels];                                     ///< what shows there, times dL/dcolour
  float total_color[kTilePixels];                                    ///< the rendered colour times dL/dcolour
  float total_all[kTilePixels];  ///< and the plane; less transmittance times dL/dalpha
  uint32_t last[kTilePixels];
  uint32_t last_of_warp[kBackwardWarps];
};

/// The state that moves from lane to lane: the blend behind the current Gaussian.
struct PassingPixel {
  float transmittance = 1, behind_color = 0, behind_all = 0;
};

template <bool kGeometry, bool kDensity>
__device__ __forceinline__ void keep_pixel(const BlendBackwardInputs& in, int tile, int i, const BackwardPixel& px,
                                           SplatBackwardShared& s) {
  const int x = tile % in.view.tiles_x * kTileSize + tile_pixel_x(i);
  const int y = tile / in.view.tiles_x * kTileSize + tile_pixel_y(i);
  const size_t n = size_t(in.view.width) * in.view.height, u = size_t(y) * in.view.width + x;
  const bool inside = x < in.view.width && y < in.view.height;
  float total = 0;
  for (int k = 0; k < 3 && inside; ++k) total += in.maps.color[k * n + u] * px.color[k];
  s.total_color[i] = total;
  if (kGeometry) {
    for (int k = 0; k < 3 && inside; ++k) total += in.maps.normal[k * n + u] * px.normal[k];
    if (inside) total += in.maps.distance[u] * px.distance;
    s.total_all[i] = total - px.transmittance * px.alpha;
    s.alpha[i] = px.alpha;
  }
  if (kDensity) {
    s.prior[i] = px.prior;
    s.ray_x[i] = px.ray.x;
    s.ray_y[i] = px.ray.y;
  }
  s.transmittance[i] = px.transmittance;
  s.background[i] = px.behind_color;
  s.last[i] = px.last;
}

/// Pixel i of the tile behind the place in front of `far`. The part of the pixel that its checkpoint does not contain
/// is behind it; the alpha map shows 1 - T.
template <bool kGeometry>
__device__ __forceinline__ PassingPixel enter_pixel(const BlendBackwardInputs& in, const SplatBackwardShared& s,
                                                    uint32_t begin, uint32_t far, int i) {
  if (s.last[i] <= far) return {s.transmittance[i], s.background[i], s.background[i]};
  const size_t at = checkpoint_index(begin, far) * kTilePixels + static_cast<size_t>(i);
  const BlendCheckpoint c = in.record.checkpoints[at];
  float seen = 0;
  for (int k = 0; k < 3; ++k) seen += c.color[k] * s.maps.color[k][i];
  PassingPixel p;
  p.transmittance = c.transmittance;
  p.behind_color = (s.total_color[i] - seen) / c.transmittance;
  if (kGeometry) {
    const PlaneCheckpoint plane = in.record.plane_checkpoints[at];
    for (int k = 0; k < 3; ++k) seen += plane.normal[k] * s.maps.normal[k][i];
    seen += plane.distance * s.maps.distance[i];
    p.behind_all = (s.total_all[i] - seen) / c.transmittance + s.alpha[i];
  }
  return p;
}

/// Every lane hands its pixel to the next one; the first lane takes that of lane `source` of `entering`.
template <bool kGeometry>
__device__ __forceinline__ void pass_pixels(const PassingPixel& entering, int source, PassingPixel& p) {
  const bool first = lane_index() == 0;
  const auto pass = [&](float mine, float theirs) {
    const float before = __shfl_up_sync(kFullWarp, mine, 1), next = __shfl_sync(kFullWarp, theirs, source);
    return first ? next : before;
  };
  p.transmittance = pass(p.transmittance, entering.transmittance);
  p.behind_color = pass(p.behind_color, entering.behind_color);
  if (kGeometry) p.behind_all = pass(p.behind_all, entering.behind_all);
}

template <bool kGeometry, bool kDensity>
__device__ __forceinline__ BackwardPixel passing_pixel(const SplatBackwardShared& s, int tile_x, int tile_y, int i,
                                                       const PassingPixel& p) {
  BackwardPixel px;
  px.x = static_cast<float>(tile_x * kTileSize + tile_pixel_x(i)) + 0.5f;
  px.y = static_cast<float>(tile_y * kTileSize + tile_pixel_y(i)) + 0.5f;
  px.color = {s.maps.color[0][i], s.maps.color[1][i], s.maps.color[2][i]};
  if (kGeometry) {
    px.normal = {s.maps.normal[0][i], s.maps.normal[1][i], s.maps.normal[2][i]};
    px.distance = s.maps.distance[i];
    px.alpha = s.alpha[i];
  }
  if (kDensity) {
    px.ray = {s.ray_x[i], s.ray_y[i], 1.0f};
    px.prior = s.prior[i];
  }
  px.last = s.last[i];
  px.transmittance = p.transmittance;
  px.behind_color = p.behind_color;
  px.behind_all = p.behind_all;
  return px;
}

/// One warp: the sums of places [32 bucket, 32 (bucket + 1)) of the tile's list, of which [0, end) were taken.
template <bool kGeometry, bool kDensity>
__device__ __forceinline__ void bucket_sums(const BlendBackwardInputs& in, const SplatBackwardShared& s, int tile,
                                            uint32_t bucket, uint32_t end, DeviceSpan<SplatGradient> slots) {
  constexpr int kStripBits = 4;
  static_assert(kTileStrips * kStripBits <= 32, "the visited strips in one word");
  const int lane = static_cast<int>(lane_index());
  const int tile_x = tile % in.view.tiles_x, tile_y = tile / in.view.tiles_x;
  const uint32_t begin = in.lists.tile_begin[tile], far = kCheckpointPlaces * (bucket + 1);
  const uint32_t place = far - 1 - static_cast<uint32_t>(lane);
  const unsigned strips = place < end ? in.record.strips[begin + place] : 0u;
  uint32_t visited = 0;  // numbers of the strips that took some of the 32
  int pixels = 0;
  for (unsigned left = __reduce_or_sync(kFullWarp, strips); left != 0; left &= left - 1) {
    visited |= static_cast<uint32_t>(__ffs(static_cast<int>(left)) - 1) << (pixels / kStripPixels * kStripBits);
    pixels += kStripPixels;
  }
  if (pixels == 0) return;
  const auto pixel_at = [&](int at) {
    const uint32_t strip = visited >> (at / kStripPixels * kStripBits) & ((1u << kStripBits) - 1u);
    return static_cast<int>(strip) * kStripPixels + at % kStripPixels;
  };
  Splat g{};
  if (strips != 0) g = in.view.splats[in.lists.gaussians[begin + place]];
  float v[kSplatGradientFloats] = {};
  WhitenedMoments<float> moments;
  PassingPixel p, entering;
  for (int step = 0; step < pixels + kWarp - 1; ++step) {
    if (step % kWarp == 0 && step < pixels) entering = enter_pixel<kGeometry>(in, s, begin, far, pixel_at(step + lane));
    pass_pixels<kGeometry>(entering, step % kWarp, p);
    const int at = step - lane;
    if (at < 0 || at >= pixels) continue;
    const int i = pixel_at(at);
    if ((strips >> (i / kStripPixels) & 1u) == 0) continue;
    BackwardPixel px = passing_pixel<kGeometry, kDensity>(s, tile_x, tile_y, i, p);
    float weight, all, by_color;
    sweep_backward<kGeometry, kDensity>(g, place, in.raster, px, weight, all, by_color);
    if (weight == 0) continue;
    add_backward_sums<kGeometry, kDensity>(s.maps, i, g, px.x - g.x, px.y - g.y, weight, all, by_color, v, moments);
    p = {px.transmittance, px.behind_color, px.behind_all};
  }
  if (strips == 0) return;
  finish_backward_sums(moments, v);
  float4* to = reinterpret_cast<float4*>(&slots[static_cast<size_t>(g.slot(tile_x, tile_y))]);
#pragma unroll
  for (int k = 0; k < kSplatGradientFloats / 4; ++k) {
    to[k] = make_float4(v[4 * k], v[4 * k + 1], v[4 * k + 2], v[4 * k + 3]);
  }
}

/// blockIdx.x: tile. The warps of all blocks of a tile take its buckets in turn.
template <bool kGeometry, bool kDensity>
__global__ void __launch_bounds__(kTilePixels)
    blend_backward_splat_kernel(BlendBackwardInputs in, DeviceSpan<SplatGradient> slots) {
  SplatBackwardShared& s = *dynamic_shared<SplatBackwardShared>();
  const int i = static_cast<int>(threadIdx.x), tile = static_cast<int>(blockIdx.x);
  const BackwardPixel px = load_backward_pixel<kGeometry, kDensity>(in, tile, i, s.maps);
  keep_pixel<kGeometry, kDensity>(in, tile, i, px, s);
  const uint32_t warp_last = __reduce_max_sync(kFullWarp, px.last);
  if (lane_index() == 0) s.last_of_warp[warp_index()] = warp_last;
  __syncthreads();
  uint32_t end = 0;
  for (int k = 0; k < kBackwardWarps; ++k) end = s.last_of_warp[k] > end ? s.last_of_warp[k] : end;
  const uint32_t buckets = (end + kCheckpointPlaces - 1) / kCheckpointPlaces;
  for (uint32_t bucket = blockIdx.y * kBackwardWarps + warp_index(); bucket < buckets;
       bucket += gridDim.y * kBackwardWarps) {
    bucket_sums<kGeometry, kDensity>(in, s, tile, bucket, end, slots);
  }
}

void blend_backward_by_splat(const DeviceContext& context, const BlendBackwardInputs& in,
                             DeviceSpan<SplatGradient> slots) {
  const unsigned tiles = static_cast<unsigned>(in.view.tiles_x) * static_cast<unsigned>(in.view.tiles_y);
  const size_t pairs = in.lists.gaussians.size, checkpoints = checkpoint_count(pairs) * kTilePixels;
  if (in.record.checkpoints.size < checkpoints || (in.geometry && in.record.plane_checkpoints.size < checkpoints)) {
    throw Error({ErrorKind::kFailed, "a backward pass per Gaussian needs checkpoints of the forward pass", {}, {}, {}});
  }
  const auto with_geometry =
      in.density ? blend_backward_splat_kernel<true, true> : blend_backward_splat_kernel<true, false>;
  const auto of_color =
      in.density ? blend_backward_splat_kernel<false, true> : blend_backward_splat_kernel<false, false>;
  const auto kernel = in.geometry ? with_geometry : of_color;
  // As many blocks per tile as give each warp one bucket of a tile of average length.
  const size_t per_block = size_t(kBackwardWarps) * kCheckpointPlaces;
  const size_t blocks = std::clamp<size_t>(pairs / (per_block * std::max(tiles, 1u)), 1, kMostBackwardBlocks);
  launch(context, "blend_backward_splat", kernel,
         {dim3(tiles, static_cast<unsigned>(blocks)), dim3(kTilePixels), sizeof(SplatBackwardShared)}, in, slots);
}

}  // namespace aligngs::cuda
