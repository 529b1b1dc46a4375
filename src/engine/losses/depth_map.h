// The plane depth of every pixel, which of them a loss may trust, and the way of dL / dz back to the maps.
#pragma once

#include <cstddef>

#include "engine/formulas/depth_terms.h"
#include "engine/formulas/pixel_rays.h"
#include "engine/losses/map_losses.h"

namespace aligngs {

/// True unless the view's mask excludes the pixel.
inline bool pixel_counts(const TrainingView& view, size_t pixel) {
  return view.data.mask.empty() || view.data.mask.data[pixel] > 0.5f;
}

/// A prior depth value, or 0 when there is none: never NaN, infinite or negative.
inline float prior_depth_at(const TrainingView& view, size_t pixel) {
  return usable_prior_depth(view.data.prior_depth.data[pixel]);
}

/// Confidence of the prior depth in [0, 1]; 1 where no weights are given, 0 where the weight is not a number.
inline float depth_weight_at(const TrainingView& view, size_t pixel) {
  return view.depth_weight.empty() ? 1.0f : usable_weight(view.depth_weight.data[pixel]);
}

/// A prior normal, or the zero vector where there is none or it is not a finite unit vector.
template <class T>
Vec3<T> prior_normal_at(const TrainingView& view, size_t pixel) {
  const float* n = view.prior_normal.data.data() + 3 * pixel;
  const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  if (!(square > 0.9f && square < 1.1f)) return {};
  return {static_cast<T>(n[0]), static_cast<T>(n[1]), static_cast<T>(n[2])};
}

/// Fills workspace.depth, .validity and clears .depth_gradient. settings.paper_normals chooses the formula
/// (engine/formulas/plane_depth.h): as printed, or guarded at grazing angles.
template <class T>
void compute_depth_map(const MapLossInputs<T>& inputs, MapLossWorkspace<T>& workspace);

/// Adds what workspace.depth_gradient (already weighted) means for the distance and normal maps.
template <class T>
void chain_depth_map(const MapLossInputs<T>& inputs, const MapLossWorkspace<T>& workspace, MapGradients<T>& gradients);

}  // namespace aligngs
