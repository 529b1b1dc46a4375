// The plane depth of every pixel, which of them a loss may trust, and the way of dL / dz back to the maps.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/vec.h"
#include "engine/losses/map_losses.h"

namespace aligngs {

/// How far a pixel's depth can be trusted. Every level asks for A > 0.5, a finite z > 0 and no mask.
enum DepthValidity : uint8_t {
  kDepthInvalid = 0,
  kDepthLoose = 1,  ///< 0.5 z_e < z < 2 z_e with z_e the alpha-normalised expected depth (guidance 2.2)
  kDepthTight = 2   ///< z within 15 % of z_e (guidance 2.5)
};

inline constexpr double kAlphaSurface = 0.5;       ///< alpha above which a pixel shows a surface
inline constexpr double kDepthTightShare = 0.15;   ///< allowed |z - z_e| / z_e (guidance 2.5)
inline constexpr double kDepthJumpShare = 0.05;    ///< |dz| / z between neighbours that is a discontinuity (guidance 2.3)
inline constexpr double kMinimumValidShare = 0.01; ///< a depth or normal loss with fewer valid pixels is zero: a
                                                   ///< handful of pixels would carry the whole weight of the term

/// Ray of pixel (x, y) through its centre, camera frame, z = 1.
template <class T>
Vec3<T> pixel_ray(const Camera& camera, int x, int y) {
  return camera.ray(x + 0.5, y + 0.5).template cast<T>();
}

/// True unless the view's mask excludes the pixel.
inline bool pixel_counts(const TrainingView& view, size_t pixel) {
  return view.data.mask.empty() || view.data.mask.data[pixel] > 0.5f;
}

/// A prior depth value, or 0 when there is none: never NaN, infinite or negative.
inline float prior_depth_at(const TrainingView& view, size_t pixel) {
  const float z = view.data.prior_depth.data[pixel];
  return z > 0 && z < 1e30f ? z : 0.0f;
}

/// Confidence of the prior depth in [0, 1]; 1 where no weights are given, 0 where the weight is not a number.
inline float depth_weight_at(const TrainingView& view, size_t pixel) {
  if (view.depth_weight.empty()) return 1.0f;
  const float w = view.depth_weight.data[pixel];
  return w > 0 && w <= 1 ? w : 0.0f;
}

/// Fills workspace.depth, .validity and clears .depth_gradient. settings.paper_normals chooses the formula
/// (engine/formulas/plane_depth.h): as printed, or guarded at grazing angles.
template <class T>
void compute_depth_map(const MapLossInputs<T>& inputs, MapLossWorkspace<T>& workspace);

/// Adds what workspace.depth_gradient (already weighted) means for the distance and normal maps.
template <class T>
void chain_depth_map(const MapLossInputs<T>& inputs, const MapLossWorkspace<T>& workspace,
                     MapGradients<T>& gradients);

}  // namespace aligngs
