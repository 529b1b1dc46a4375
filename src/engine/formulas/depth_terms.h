// Losses on the plane depth at one pixel: the validity of a depth, and dL/dz carried back to the maps. Terms: the Huber
// norm of its log ratio to the prior (our default), the Pearson correlation with it (AlignGS, Gao et al. 2025).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

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

// ---- log depth ----

inline constexpr double kHuberMinimum = 1e-9;  ///< log units: a delta of 0 means the absolute value

/// log(x) for normal positive x in a form that loops over pixels can vectorise. Within 2 ulp for float (the polynomial
/// of Cephes' logf), the library's for double.
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE float log_of_positive(float x) {
  int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  const int32_t e = (bits - 0x3f3504f3) >> 23;  // x = m 2^e with m in [sqrt(1/2), sqrt(2))
  bits -= e * (1 << 23);
  float m;
  std::memcpy(&m, &bits, sizeof m);
  m -= 1.0f;
  float p = 7.0376836292e-2f;
  p = p * m - 1.1514610310e-1f;
  p = p * m + 1.1676998740e-1f;
  p = p * m - 1.2420140846e-1f;
  p = p * m + 1.4249322787e-1f;
  p = p * m - 1.6668057665e-1f;
  p = p * m + 2.0000714765e-1f;
  p = p * m - 2.4999993993e-1f;
  p = p * m + 3.3333331174e-1f;
  const float z = m * m, n = static_cast<float>(e);
  const float y = p * m * z + n * -2.12194440e-4f - 0.5f * z;
  return n * 0.693359375f + (m + y);
}
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE double log_of_positive(double x) { return std::log(x); }

/// Weight of a pixel in the log-depth loss, 0 where it does not take part.
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE float log_depth_weight(uint8_t validity, float prior, float weight) {
  const bool known = prior > 0 && prior<1e30f, counts = weight> 0 && weight <= 1;  // as usable_prior_depth, _weight
  return validity == kDepthTight && known && counts ? weight : 0.0f;
}

template <class T>
struct LogDepthTerm {
  T value{};     ///< w h(e), e = log(z / (a prior))
  T gradient{};  ///< step w h'(e) / z
};
/// h(e) = e^2 / (2 delta) for |e| <= delta, else |e| - delta / 2. Zero without a weight.
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE LogDepthTerm<T> log_depth_term(T depth, float prior, float weight, T scale, T delta,
                                                                T step) {
  const T inverse_delta = T(1) / delta;
  const bool used = weight > 0.0f;
  const T z = used ? depth : T(1), target = used ? scale * static_cast<T>(prior) : T(1);
  const T w = static_cast<T>(weight), e = log_of_positive(z / target);
  const T low = e < -delta ? -delta : e, near = low > delta ? delta : low;  // h = near (e - near / 2) / delta
  return {w * near * (e - near / T(2)) * inverse_delta, step * w * near * inverse_delta / z};
}

// ---- Pearson ----

inline constexpr double kPearsonMinimumShare = 0.05;    ///< of the pixels must be valid: fewer say little
inline constexpr double kPearsonMinimumSpread = 0.05;   ///< standard deviation / mean of the prior: a flat one correlates with noise
inline constexpr double kPearsonRenderedSpread = 0.01;  ///< of the rendered depth: the gradient grows as 1 / spread
inline constexpr double kPearsonEpsilon = 1e-6;         ///< added to both standard deviations, as released

ALIGNGS_HD inline bool enough_for_pearson(double valid, double pixels) {
  return !(valid < 3) && !(valid < kPearsonMinimumShare * pixels);
}

/// Means over the valid pixels, and sums of the squares and products of the deviations from them.
struct PearsonMoments {
  double count = 0, mean_rendered = 0, mean_prior = 0;
  double rendered = 0, prior = 0, product = 0;
};

/// 1 - rho, and its gradient dL/dz = along_rendered (z - mean) - along_prior (prior - mean), weight included. All zero
/// when the prior or the rendering is (nearly) one frontal plane.
struct PearsonResult {
  double loss = 0, along_rendered = 0, along_prior = 0;
};
/// d rho / d a_k = b_k / (n t_a t_b) - rho a_k / ((n - 1) s_a t_a); both parts sum to zero over k, so the dependence of
/// a on the mean adds nothing.
ALIGNGS_HD inline PearsonResult pearson_result(const PearsonMoments& m, double weight) {
  const double n = m.count;
  const double deviation_rendered = std::sqrt(m.rendered / (n - 1));
  const double deviation_prior = std::sqrt(m.prior / (n - 1));
  if (deviation_prior < kPearsonMinimumSpread * m.mean_prior) return {};
  if (deviation_rendered < kPearsonRenderedSpread * m.mean_rendered) return {};
  const double t_rendered = deviation_rendered + kPearsonEpsilon, t_prior = deviation_prior + kPearsonEpsilon;
  const double rho = m.product / (n * t_rendered * t_prior);
  return {1 - rho, weight * rho / ((n - 1) * deviation_rendered * t_rendered), weight / (n * t_rendered * t_prior)};
}

}  // namespace aligngs
