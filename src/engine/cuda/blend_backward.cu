#include "engine/cuda/blend_backward.h"

#include <algorithm>

#include "core/error.h"
#include "device/launch.h"
#include "engine/cuda/blend_backward.cuh"
#include "engine/cuda/blend_backward_splat.cuh"

namespace aligngs::cuda {
namespace {

void per_pixel(const DeviceContext& context, const BlendBackwardInputs& in, unsigned tiles,
               DeviceSpan<SplatGradient> slots) {
  const auto with_geometry = in.density ? blend_backward_kernel<true, true> : blend_backward_kernel<true, false>;
  const auto of_color = in.density ? blend_backward_kernel<false, true> : blend_backward_kernel<false, false>;
  const auto kernel = in.geometry ? with_geometry : of_color;
  launch(context, "blend_backward", kernel, {dim3(tiles), dim3(kTilePixels), sizeof(BlendBackwardShared)}, in, slots);
}

void per_splat(const DeviceContext& context, const BlendBackwardInputs& in, unsigned tiles,
               DeviceSpan<SplatGradient> slots) {
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

}  // namespace

void blend_backward(const DeviceContext& context, const BlendBackwardInputs& in, DeviceSpan<SplatGradient> slots) {
  const unsigned tiles = static_cast<unsigned>(in.view.tiles_x) * static_cast<unsigned>(in.view.tiles_y);
  if (in.method == BlendBackwardMethod::kPerSplat) {
    per_splat(context, in, tiles, slots);
  } else {
    per_pixel(context, in, tiles, slots);
  }
}

}  // namespace aligngs::cuda
