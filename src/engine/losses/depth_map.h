// The plane depth of every pixel, which of them a loss may trust, and the way of dL / dz back to the maps.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/vec.h"
#include "engine/formulas/plane_depth.h"
#include "engine/losses/map_losses.h"

namespace aligngs {

/// How far a pixel's depth can be trusted. Every level asks for A > 0.5, a finite z > 0 and a pixel that the
/// mask keeps.
enum DepthValidity : uint8_t {
  kDepthInvalid = 0,
  kDepthLoose = 1,  ///< 0.5 z_e < z < 2 z_e with z_e the alpha-normalised expected depth (guidance 2.2)
  kDepthTight = 2   ///< z within 15 % of z_e (plane_depth_valid)
};

inline constexpr double kDepthJumpShare = 0.05;  ///< |dz| / z of neighbours that is a discontinuity (guidance 2.3)
/// A depth or normal loss with fewer valid pixels is zero: a handful would carry the whole weight of the term.
inline constexpr double kMinimumValidShare = 0.01;

/// Camera::ray of pixel centres in T, without a division per pixel.
template <class T>
struct PixelRays {
  T step_x, step_y, first_x, first_y;
  explicit PixelRays(const Camera& camera)
      : step_x(static_cast<T>(1 / camera.fx)),
        step_y(static_cast<T>(1 / camera.fy)),
        first_x(static_cast<T>(0.5 - camera.cx)),
        first_y(static_cast<T>(0.5 - camera.cy)) {}
  Vec3<T> operator()(int x, int y) const {
    return {(static_cast<T>(x) + first_x) * step_x, (static_cast<T>(y) + first_y) * step_y, T(1)};
  }
};

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
