// Front-to-back blending of projected Gaussians at one pixel, and its derivatives. Formulas of 3DGS (Kerbl et
// al. 2023) with the constants of engine/settings.h; the depth at which a ray meets a Gaussian's plane.
#pragma once

#include <cmath>

#include "engine/formulas/projection.h"

namespace aligngs {

/// alpha of one Gaussian at one pixel. alpha == 0 means that it does not take part.
template <class T>
struct AlphaSample {
  T alpha{};     ///< in [0, alpha_max]
  T falloff{};   ///< exp(power), in (0, 1]
  T slope{};     ///< d alpha / d (opacity * falloff); 1 in between, 0 above alpha_max
  T dx{}, dy{};  ///< pixel centre - mean, pixels
};

/// power = -1/2 (a dx^2 + c dy^2) - b dx dy; skipped when > 0 (rounding of an extreme conic);
/// alpha = min(alpha_max, opacity exp(power)); skipped below alpha_min. With settings.smooth_cutoff the cut is the
/// C1 ramp h(t) = t^2 (3 - 2 t), t = (raw - alpha_min) / alpha_min, which multiplies raw over [alpha_min, 2 alpha_min].
template <class T>
ALIGNGS_HD inline AlphaSample<T> alpha_at(const Vec2<T>& mean, const Symmetric2<T>& conic, T opacity, T pixel_x,
                                          T pixel_y, const RasterSettings& settings) {
  using std::exp;
  AlphaSample<T> s;
  s.dx = pixel_x - mean.x;
  s.dy = pixel_y - mean.y;
  const T power = T(-0.5) * (conic.xx * s.dx * s.dx + conic.yy * s.dy * s.dy) - conic.xy * s.dx * s.dy;
  if (!(power <= T(0))) return s;
  s.falloff = exp(power);
  const T raw = opacity * s.falloff;
  const T alpha_min = T(settings.alpha_min), alpha_max = T(settings.alpha_max);
  if (!(raw >= alpha_min)) return s;
  s.alpha = raw;
  s.slope = T(1);
  if (settings.smooth_cutoff && raw < T(2) * alpha_min) {
    const T t = raw / alpha_min - T(1);
    const T ramp = t * t * (T(3) - T(2) * t);
    s.alpha = raw * ramp;
    s.slope = ramp + raw * T(6) * t * (T(1) - t) / alpha_min;
  }
  if (s.alpha > alpha_max) {
    s.alpha = alpha_max;
    s.slope = T(0);
  }
  return s;
}

/// Adds dL/d(mean, conic, opacity) of one pixel to `out`, given dL/dalpha. Returns dL/dmean of this pixel alone,
/// whose magnitudes the AbsGS statistic sums.
template <class T>
ALIGNGS_HD inline Vec2<T> alpha_backward(const AlphaSample<T>& s, const Symmetric2<T>& conic, T opacity, T dalpha,
                                         ProjectionGradient<T>& out) {
  const T draw = dalpha * s.slope;
  const T dpower = draw * opacity * s.falloff;
  const Vec2<T> dmean{dpower * (conic.xx * s.dx + conic.xy * s.dy), dpower * (conic.yy * s.dy + conic.xy * s.dx)};
  out.opacity += draw * s.falloff;
  out.conic.xx += T(-0.5) * s.dx * s.dx * dpower;
  out.conic.xy += -s.dx * s.dy * dpower;
  out.conic.yy += T(-0.5) * s.dy * s.dy * dpower;
  out.mean.x += dmean.x;
  out.mean.y += dmean.y;
  return dmean;
}

/// One step of front-to-back blending. False: the pixel is full and this Gaussian is *not* blended, nor any after
/// it (T (1 - alpha) would fall below transmittance_min).
template <class T>
ALIGNGS_HD inline bool blend_step(T alpha, T transmittance_min, T& transmittance, T& weight) {
  const T next = transmittance * (T(1) - alpha);
  if (next < transmittance_min) return false;
  weight = alpha * transmittance;
  transmittance = next;
  return true;
}

/// dL/dalpha of the Gaussians of a pixel, FRONT TO BACK and without dividing by the transmittance.
///
/// A blended map is M = sum_k w_k v_k + T_final b with w_k = alpha_k T_k and T_{k+1} = T_k (1 - alpha_k). Its gradient
/// is g = dL/dM, and q_k = v_k . g. Every Gaussian behind j carries the factor (1 - alpha_j), so
///   dL/dalpha_j = T_j q_j - [sum_{k>j} w_k q_k + T_final b . g] / (1 - alpha_j)
///               = T_j q_j - (total - prefix_j) / (1 - alpha_j),
///   total = sum_k w_k q_k + T_final b . g,   prefix_j = sum_{k<=j} w_k q_k   (inclusive).
/// 1 - alpha_j >= 1 - alpha_max, so the division is safe. `total` must be the sum of the *same* rounded q_k that the
/// prefix uses, in the same order. M . g from another rounding does not cancel behind a nearly opaque surface.
template <class T>
struct AlphaSweep {
  T total{};
  T prefix{};

  /// Call front to back for every Gaussian that was blended; `transmittance` is the one before it.
  ALIGNGS_HD T next(T alpha, T transmittance, T weight, T q) {
    prefix += weight * q;
    return transmittance * q - (total - prefix) / (T(1) - alpha);
  }
};

/// Below this cosine between ray and plane the intersection says nothing and the centre's depth is used.
inline constexpr double kGrazingCosine = 0.1;

/// Depth at which the ray r (z = 1) meets the Gaussian's plane, d / (-n . r), clamped to the centre's depth
/// +- 3 standard deviations of the largest axis. No gradient flows here.
template <class T>
ALIGNGS_HD inline T intersection_depth(const Projection<T>& p, const Vec3<T>& ray) {
  const T s = -dot(p.normal, ray);
  if (s < T(kGrazingCosine) * norm(ray)) return p.z;
  return clamp_to(p.distance / s, p.z_min, p.z_max);
}

/// Transmittance at which the median depth is taken.
inline constexpr double kMedianTransmittance = 0.5;

/// Relative difference between a Gaussian's depth at a pixel and the prior's above which the prior does not
/// support it (DensityStatistics::unsupported).
inline constexpr double kPriorSupport = 0.05;

/// True where the prior has no depth (0 or non-finite) or disagrees with this Gaussian's intersection depth.
template <class T>
ALIGNGS_HD inline bool prior_unsupported(T prior_depth, T z) {
  if (!(prior_depth > T(0)) || !is_finite(prior_depth)) return true;
  const T difference = z - prior_depth;
  return (difference < T(0) ? -difference : difference) > T(kPriorSupport) * prior_depth;
}

}  // namespace aligngs
