// Kernels of pose_gradient.h.
#include "engine/cuda/pose_gradient.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/partial_sums.cuh"

namespace aligngs::cuda {

enum PoseSum : int { kPoseRotation = 0, kPoseTranslation = 3, kPoseSums = 6 };

__global__ void __launch_bounds__(kGradientThreads)
    pose_gradient_kernel(PoseGradientInputs in, DeviceSpan<double> partial) {
  const size_t i = item_index();
  double sums[kPoseSums] = {};
  if (i < in.model.gaussians && in.touched[i] != 0) {
    const PoseGradient<float> share =
        row_pose_gradient(in.camera, pose_row<float>(in.model, in.gradients, i), in.sh_degree);
    for (int k = 0; k < 3; ++k) sums[kPoseRotation + k] = share.rotation[k];
    for (int k = 0; k < 3; ++k) sums[kPoseTranslation + k] = share.translation[k];
  }
  store_partial_sums(sums, partial);
}

__global__ void __launch_bounds__(kSumThreads)
    finish_pose_gradient_kernel(DeviceSpan<const double> partial, DeviceSpan<PoseGradient<double>> out) {
  double sums[kPoseSums];
  load_partial_sums(partial, sums);
  if (threadIdx.x != 0) return;
  const double *rotation = sums + kPoseRotation, *translation = sums + kPoseTranslation;
  out[0].rotation = {rotation[0], rotation[1], rotation[2]};
  out[0].translation = {translation[0], translation[1], translation[2]};
}

void pose_gradient(DeviceArena& arena, const PoseGradientInputs& in, DeviceSpan<PoseGradient<double>> out) {
  const LaunchShape shape = one_per_item(in.model.gaussians, kGradientThreads);
  const DeviceSpan<double> partial = arena.take<double>(shape.grid.x * size_t(kPoseSums), "sums of the pose gradient");
  launch(arena.context(), "pose_gradient", pose_gradient_kernel, shape, in, partial);
  launch(arena.context(), "finish_pose_gradient", finish_pose_gradient_kernel, {dim3(1), dim3(kSumThreads), 0}, partial,
         out);
}

}  // namespace aligngs::cuda
