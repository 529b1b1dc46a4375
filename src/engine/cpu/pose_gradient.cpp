#include "engine/cpu/pose_gradient.h"

#include <vector>

#include "engine/formulas/pose_rows.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kPoseRowsPerTask = 512;  // rows per task, and the unit in which sums are formed

}  // namespace

PoseGradient<double> pose_gradient(const GaussianModel& model, const ParameterGradients& gradients,
                                   const Camera& camera, int sh_degree, ThreadPool& pool) {
  const PoseFrame<float> frame = pose_frame<float>(camera);
  std::vector<PoseGradient<double>> chunks((model.size() + kPoseRowsPerTask - 1) / kPoseRowsPerTask);
  pool.parallel_for(model.size(), kPoseRowsPerTask, [&](size_t begin, size_t end, int) {
    PoseGradient<double>& sum = chunks[begin / kPoseRowsPerTask];
    for (size_t i = begin; i < end; ++i) {
      if (gradients.touched[i] == 0) continue;  // its gradients are those of the shape terms, which know no camera
      const PoseGradient<float> share = row_pose_gradient(frame, pose_row<float>(model, gradients, i), sh_degree);
      sum.rotation += share.rotation.cast<double>();
      sum.translation += share.translation.cast<double>();
    }
  });
  PoseGradient<double> total;
  for (const PoseGradient<double>& chunk : chunks) {
    total.rotation += chunk.rotation;
    total.translation += chunk.translation;
  }
  return total;
}

}  // namespace aligngs::cpu
