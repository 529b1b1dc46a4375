// The plane depth at one pixel as losses take it: its validity, and dL/dz carried back to the maps.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/always_inline.h"
#include "engine/formulas/plane_depth.h"

namespace aligngs {

/// How far a pixel's depth can be trusted. Every level asks for A > 0.5, a finite z > 0 and a pixel that the
/// mask keeps.
enum DepthValidity : uint8_t {
  kDepthInvalid = 0,
  kDepthLoose = 1,  ///< 0.5 z_e < z < 2 z_e with z_e the alpha-normalised expected depth
  kDepthTight = 2   ///< z within 15 % of z_e (plane_depth_valid)
};

inline constexpr double kDepthJumpShare = 0.05;  ///< |dz| / z of neighbours that is a discontinuity
/// A depth or normal loss with fewer valid pixels is zero: a handful would carry the whole weight of the term.
inline constexpr double kMinimumValidShare = 0.01;

ALIGNGS_HD inline bool enough_valid(double valid, double pixels) {
  return !(valid < 1) && !(valid < kMinimumValidShare * pixels);
}

/// A prior depth value, or 0 when there is none: never NaN, infinite or negative.
ALIGNGS_HD inline float usable_prior_depth(float z) { return z > 0 && z < 1e30f ? z : 0.0f; }
/// A confidence in [0, 1]; 0 where it is not a number.
ALIGNGS_HD inline float usable_weight(float w) { return w > 0 && w <= 1 ? w : 0.0f; }

// ---- depth ----

/// 1 / s of the guarded plane depth z = D / s (plane_depth.h), in a form that loops over pixels can vectorise:
/// selections of plain values, not branches. If a pixel has no depth, its numbers are replaced by harmless ones.
template <class T>
struct PlaneSlope {
  T inverse{};           ///< 0 where there is no depth
  bool clamped = false;  ///< s does not depend on the normal
};
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE PlaneSlope<T> plane_slope(T n_x, T n_y, T n_z, T alpha, T distance, T ray_x, T ray_y) {
  using std::sqrt;
  const bool covered = (alpha > T(0)) & (distance > T(0));
  const T s = -(n_x * ray_x + n_y * ray_y + n_z);
  const T floor = T(kPlaneSlopeMin) * alpha * sqrt(ray_x * ray_x + ray_y * ray_y + T(1));
  const bool clamped = !(s > floor);
  const T used = clamped ? floor : s, safe = covered ? used : T(1);
  return {covered ? T(1) / safe : T(0), clamped};
}

template <class T>
struct DepthSample {
  T z{};      ///< 0 where the level is kDepthInvalid
  T level{};  ///< DepthValidity as a number, so that it is as wide as the depth
};

/// The level of a depth z; `expected` is the blended, not normalised map.
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE DepthSample<T> judge_depth(T z, T alpha, T expected) {
  using std::abs;
  const bool solid = (alpha > T(kPlaneAlphaLoss)) & (z > T(0));
  const T mean = expected / (solid ? alpha : T(1));
  const bool tight = solid & (expected > T(0)) & (abs(z - mean) <= T(kPlaneExpectedBand) * mean);
  const bool loose = solid & (z > T(0.5) * mean) & (z < T(2) * mean);
  const T level = tight ? T(kDepthTight) : (loose ? T(kDepthLoose) : T(kDepthInvalid));
  return {(tight | loose) ? z : T(0), level};
}

/// Gradients of the maps from dL/dz = g, of the guarded form.
template <class T>
struct DepthGradient {
  T distance{};
  T normal{};  ///< times the ray
};
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE DepthGradient<T> plane_depth_gradient(T g, const PlaneSlope<T>& slope, T distance) {
  const T by_distance = g * slope.inverse;
  const T along = by_distance * distance * slope.inverse;
  // Not finite where the maps are not; such pixels have no gradient.
  const T by_ray = ((g != T(0)) & !slope.clamped) ? along : T(0);
  return {g != T(0) ? by_distance : T(0), by_ray};
}

}  // namespace aligngs
