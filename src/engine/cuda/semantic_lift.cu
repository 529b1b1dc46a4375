#include "engine/cuda/semantic_lift.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/semantic_lift.cuh"

namespace aligngs::cuda {

void add_teacher_sums(DeviceArena& arena, const LiftInputs& in, DeviceSpan<float> sums) {
  const DeviceContext& context = arena.context();
  const DeviceSpan<float> slots =
      arena.take<float>(in.lists.gaussians.size * kLiftChannels, "teacher sums of (Gaussian, tile) pairs");
  const LaunchShape shape{dim3(static_cast<unsigned>(in.view.tiles_x), static_cast<unsigned>(in.view.tiles_y)),
                          dim3(kTilePixels), 0};
  const size_t rows = in.lists.slot_begin.size - 1;
  for (int sweep = 0; sweep < in.teacher.channels; sweep += kLiftChannels) {
    launch(context, "lift_tiles", lift_tiles, shape, in, sweep, slots);
    launch(context, "add_slots", add_slots, one_per_item(rows * kLiftChannels, kRowThreads), in.lists, slots, sweep,
           in.teacher.channels, sums);
  }
}

void start_semantic_rows(const DeviceContext& context, DeviceSpan<const float> sums, int remainder,
                         const ModelSpans& model) {
  launch(context, "start_rows", start_rows, one_per_item(model.gaussians, kRowThreads), sums, remainder, model);
}

}  // namespace aligngs::cuda
