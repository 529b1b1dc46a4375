// The specification of StepReport::pose: the formula over all rows, in one loop.
#pragma once

#include "engine/formulas/pose_rows.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::reference {

/// From the gradients of a step's losses and the model that they were taken at.
template <class T>
PoseGradient<T> pose_gradient(const GaussianModelT<T>& model, const GaussianModelT<T>& gradients, const Camera& camera,
                              int sh_degree) {
  const PoseFrame<T> frame = pose_frame<T>(camera);
  PoseGradient<T> sum;
  for (size_t i = 0; i < model.size(); ++i) {
    const PoseGradient<T> share = row_pose_gradient(frame, pose_row<T>(model, gradients, i), sh_degree);
    sum.rotation += share.rotation;
    sum.translation += share.translation;
  }
  return sum;
}

}  // namespace aligngs::reference
