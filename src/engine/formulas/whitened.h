// Opacity of a Gaussian at a pixel and its derivatives in whitened coordinates (splat.h). The values equal alpha_at of
// blending.h and the conic of projection.h, without their cancellation for needles in float.
#pragma once

#include <cmath>

#include "engine/formulas/projection.h"
#include "engine/formulas/splat.h"

namespace aligngs {

inline constexpr double kHalfLog2E = 0.72134752044448170368;  ///< log2(e) / 2: exp(-m / 2) = 2^(-kHalfLog2E m)
inline constexpr double kTwoLn2 = 1.38629436111989061883;     ///< the conic is 2 ln 2 F F^T

/// F = [xx 0; xy yy].
template <class T>
struct WhiteningFactor {
  T xx{}, xy{}, yy{};
};

/// F of a visible Gaussian: F F^T = log2(e)/2 A.
template <class T>
ALIGNGS_HD inline WhiteningFactor<T> whitening_factor(const Projection<T>& p) {
  using std::sqrt;
  WhiteningFactor<T> f;
  f.xx = sqrt(T(kHalfLog2E) * p.conic.xx);
  f.xy = T(kHalfLog2E) * p.conic.xy / f.xx;
  f.yy = sqrt(T(kHalfLog2E) / p.covariance.yy);
  return f;
}

/// One Gaussian at one pixel.
struct WhitenedAlpha {
  float alpha = 0;      ///< in [0, alpha_max]; 0 where raw opacity is below alpha_min
  float slope = 0;      ///< d alpha / d power, power being the natural logarithm of the falloff
  float p = 0, r = 0;   ///< whitened offset F^T (pixel - mean)
  bool wanted = false;  ///< raw opacity >= alpha_min
};

/// (pixel_x, pixel_y) is the pixel's centre. Every product that is added to something is an explicit fma. All its
/// compilations, forward and backward, host and device, hence agree on every bit but the last of exp2.
ALIGNGS_HD inline WhitenedAlpha whitened_alpha(const Splat& g, float pixel_x, float pixel_y,
                                               const RasterSettings& settings) {
  using std::exp2;
  using std::fma;
  WhitenedAlpha a;
  const float dx = pixel_x - g.x, dy = pixel_y - g.y;
  a.p = fma(g.fxy, dy, g.fxx * dx);
  a.r = g.fyy * dy;
  const float raw = g.opacity * exp2(-fma(a.p, a.p, a.r * a.r));
  a.wanted = raw >= settings.alpha_min;
  if (!a.wanted) return a;
  a.alpha = raw;
  a.slope = raw;
  if (settings.smooth_cutoff && raw < 2 * settings.alpha_min) {
    const float t = raw / settings.alpha_min - 1;
    const float ramp = t * t * fma(-2.0f, t, 3.0f);
    a.alpha = raw * ramp;
    a.slope = raw * (ramp + raw * 6 * t * (1 - t) / settings.alpha_min);
  }
  if (raw >= settings.alpha_max) {
    a.alpha = settings.alpha_max;
    a.slope = 0;
  }
  return a;
}

/// Sums over pixels of g = dL/dpower times powers of the whitened offset.
template <class T>
struct WhitenedMoments {
  T p{}, r{}, one{}, pp{}, pr{}, rr{};
};

template <class T>
ALIGNGS_HD inline void add_moment(T g, T p, T r, WhitenedMoments<T>& m) {
  const T gp = g * p, gr = g * r;
  m.p += gp;
  m.r += gr;
  m.one += g;
  m.pp += gp * p;
  m.pr += gp * r;
  m.rr += gr * r;
}

/// dL/dmean, pixels^-1, from the first moments.
template <class T>
ALIGNGS_HD inline Vec2<T> whitened_mean_gradient(const WhiteningFactor<T>& f, T p, T r) {
  return {T(kTwoLn2) * f.xx * p, T(kTwoLn2) * (f.xy * p + f.yy * r)};
}

/// dL/dcovariance, xy counted once: with M the second moments and A = k F F^T,
///   dC = -A dL/dA A = k^2/2 F M F^T,
/// which unlike the way over dL/dA does not cancel for needles.
template <class T>
ALIGNGS_HD inline Symmetric2<T> whitened_covariance_gradient(const WhiteningFactor<T>& f, T pp, T pr, T rr) {
  const T half = T(0.5 * kTwoLn2 * kTwoLn2);
  const T row_p = f.xy * pp + f.yy * pr, row_r = f.xy * pr + f.yy * rr;
  return {half * f.xx * f.xx * pp, T(2) * half * f.xx * row_p, half * (f.xy * row_p + f.yy * row_r)};
}

}  // namespace aligngs
