#include "engine/cuda/blend_backward.h"

#include "engine/cuda/blend_backward.cuh"
#include "engine/cuda/runtime/launch.h"

namespace aligngs::cuda {

void blend_backward(const DeviceContext& context, const BlendBackwardInputs& in, DeviceSpan<SplatGradient> slots) {
  const auto with_geometry = in.density ? blend_backward_kernel<true, true> : blend_backward_kernel<true, false>;
  const auto of_color = in.density ? blend_backward_kernel<false, true> : blend_backward_kernel<false, false>;
  const auto kernel = in.geometry ? with_geometry : of_color;
  const unsigned tiles = static_cast<unsigned>(in.view.tiles_x) * static_cast<unsigned>(in.view.tiles_y);
  launch(context, "blend_backward", kernel, {dim3(tiles), dim3(kTilePixels), sizeof(BlendBackwardShared)}, in, slots);
}

}  // namespace aligngs::cuda
