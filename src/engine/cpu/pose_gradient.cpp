#include "engine/cpu/pose_gradient.h"

#include <vector>

namespace aligngs::cpu {
namespace {

constexpr size_t kGrain = 512;  // rows per task, and the unit in which sums are formed

PoseRow<float> row_of(const GaussianModel& model, const ParameterGradients& g, size_t i) {
  PoseRow<float> row;
  for (int k = 0; k < 3; ++k) {
    row.position[k] = model.positions[3 * i + static_cast<size_t>(k)];
    row.dposition[k] = g.positions[3 * i + static_cast<size_t>(k)];
  }
  row.quaternion = &model.rotations[4 * i];
  row.dquaternion = &g.rotations[4 * i];
  row.sh = &model.sh[3 * kShCoefficients * i];
  row.dsh = &g.sh[3 * kShCoefficients * i];
  return row;
}

}  // namespace

PoseGradient<double> pose_gradient(const GaussianModel& model, const ParameterGradients& gradients, const Camera& camera, int sh_degree,
                                   ThreadPool& pool) {
  const PoseFrame<float> frame{camera.world_to_camera.rotation.cast<float>(), camera.world_to_camera.translation.cast<float>(),
                               camera.centre().cast<float>()};
  std::vector<PoseGradient<double>> chunks((model.size() + kGrain - 1) / kGrain);
  pool.parallel_for(model.size(), kGrain, [&](size_t begin, size_t end, int) {
    PoseGradient<double>& sum = chunks[begin / kGrain];
    for (size_t i = begin; i < end; ++i) {
      if (gradients.touched[i] == 0) continue;  // its gradients are those of the shape terms, which know no camera
      const PoseGradient<float> share = row_pose_gradient(frame, row_of(model, gradients, i), sh_degree);
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
