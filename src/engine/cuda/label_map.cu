#include "engine/cuda/label_map.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/label_map.cuh"

namespace aligngs::cuda {

void label_map(DeviceArena& arena, const LabelInputs& in, const LabelOutputs& out) {
  const DeviceContext& context = arena.context();
  DeviceSpan<float> log_sums;
  if (in.blend == SemanticBlend::kProbabilities) {
    log_sums = arena.take<float>(in.model.gaussians, "sums of semantic rows");
    launch(context, "row_log_sums", row_log_sums, one_per_item(in.model.gaussians, kRowThreads), in, log_sums);
  }
  const LaunchShape shape{dim3(static_cast<unsigned>(in.view.tiles_x), static_cast<unsigned>(in.view.tiles_y)),
                          dim3(kTilePixels), 0};
  launch(context, "label_tiles", label_tiles, shape, in, log_sums, out);
}

}  // namespace aligngs::cuda
