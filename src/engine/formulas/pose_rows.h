// Inputs of row_pose_gradient(), taken from a camera and from arrays laid out as in GaussianModel.
#pragma once

#include "engine/formulas/pose_gradient.h"
#include "scene/camera.h"

namespace aligngs {

template <class T>
inline PoseFrame<T> pose_frame(const Camera& camera) {
  const Rigidd& pose = camera.world_to_camera;
  return {pose.rotation.cast<T>(), pose.translation.cast<T>(), camera.centre().cast<T>()};
}

/// Row i of a model and of its gradients: anything with positions, rotations and sh as GaussianModel has them, on host
/// or device.
template <class T, class Model, class Gradients>
ALIGNGS_HD inline PoseRow<T> pose_row(const Model& model, const Gradients& gradients, size_t i) {
  PoseRow<T> row;
  for (int k = 0; k < 3; ++k) {
    row.position[k] = model.positions[3 * i + static_cast<size_t>(k)];
    row.dposition[k] = gradients.positions[3 * i + static_cast<size_t>(k)];
  }
  row.quaternion = &model.rotations[4 * i];
  row.dquaternion = &gradients.rotations[4 * i];
  row.sh = &model.sh[3 * kShCoefficients * i];
  row.dsh = &gradients.sh[3 * kShCoefficients * i];
  return row;
}

}  // namespace aligngs
