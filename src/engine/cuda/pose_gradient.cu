#include "engine/cuda/pose_gradient.h"

#include "device/launch.h"
#include "engine/cuda/pose_gradient.cuh"

namespace aligngs::cuda {

void pose_gradient(DeviceArena& arena, const PoseGradientInputs& in, DeviceSpan<PoseGradient<double>> out) {
  const LaunchShape shape = one_per_item(in.model.gaussians, kGradientThreads);
  const DeviceSpan<double> partial = arena.take<double>(shape.grid.x * size_t(kPoseSums), "sums of the pose gradient");
  launch(arena.context(), "pose_gradient", pose_gradient_kernel, shape, in, partial);
  launch(arena.context(), "finish_pose_gradient", finish_pose_gradient_kernel, {dim3(1), dim3(kSumThreads), 0}, partial,
         out);
}

}  // namespace aligngs::cuda
