// Supervision of the blended normals by the normals of the prior depth.
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

/// A prior normal, or the zero vector where there is none or it is not a finite unit vector.
template <class T>
Vec3<T> prior_normal_at(const TrainingView& view, size_t pixel) {
  const float* n = view.prior_normal.data.data() + 3 * pixel;
  const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  if (!(square > 0.9f && square < 1.1f)) return {};
  return {static_cast<T>(n[0]), static_cast<T>(n[1]), static_cast<T>(n[2])};
}

/// sum w (1 - n . n_prior) / sum w over pixels with a blended direction and a prior normal, w = view.depth_weight.
/// Zero without prior normals or with fewer than 1 % valid pixels.
/// Needs compute_unit_normals.
template <class T>
double prior_normal_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace,
                         MapGradients<T>& gradients);

}  // namespace aligngs
