#include "engine/cuda/finish_maps.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/finish_maps.cuh"

namespace aligngs::cuda {

void finish_maps(const DeviceContext& context, const ViewSpans& view, const RenderMapSpans& maps,
                 const FinishedMaps& out) {
  launch(context, "finish_pixels", finish_pixels, one_per_item(maps.alpha.size, kRowThreads), view, maps, out);
}

}  // namespace aligngs::cuda
