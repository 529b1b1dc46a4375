#include "engine/cuda/blend_forward.h"

#include "device/launch.h"
#include "engine/cuda/blend_forward.cuh"

namespace aligngs::cuda {

void blend_forward(const DeviceContext& context, const BlendForwardInputs& in, const RenderMapSpans& maps,
                   const BlendRecordSpans& record) {
  const LaunchShape shape{dim3(static_cast<unsigned>(in.view.tiles_x), static_cast<unsigned>(in.view.tiles_y)),
                          dim3(kTilePixels), 0};
  launch(context, "blend_tiles", in.geometry ? blend_tiles<true> : blend_tiles<false>, shape, in, maps, record);
}

}  // namespace aligngs::cuda
