// L_z, our depth loss where the prior is metric: Huber norm of the log ratio of rendered and prior depth.
#pragma once

#include <cmath>
#include <cstring>

#include "engine/formulas/depth_terms.h"
#include "engine/losses/terms/pixel_term.h"
#include "engine/settings.h"

namespace aligngs {

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

/// Pixels with tight depth validity and a prior p, weighted by its confidence. With e = log(z / (a p)),
/// a = LossSettings::prior_depth_scale and delta = log_depth_huber: e^2 / (2 delta) for |e| <= delta, else
/// |e| - delta / 2. The slope by e is hence at most 1. No pixel takes part unless a > 0.
template <class T>
struct LogDepthTerm {
  static constexpr Loss kLoss = Loss::kLogDepth;
  T scale, delta;

  ALIGNGS_HD explicit LogDepthTerm(const LossSettings& s)
      : scale(static_cast<T>(s.prior_depth_scale)),
        delta(static_cast<T>(s.log_depth_huber > kHuberMinimum ? static_cast<double>(s.log_depth_huber)
                                                               : kHuberMinimum)) {}

  ALIGNGS_HD ALIGNGS_ALWAYS_INLINE T weight(const TermPixel<T>& p) const {
    const bool known = (p.prior_depth > 0) & (p.prior_depth < 1e30f) & (scale > T(0));  // as usable_prior_depth
    const bool counts = (p.confidence > 0) & (p.confidence <= 1);
    const bool used = (p.validity == kDepthTight) & known & counts;
    return used ? static_cast<T>(p.confidence) : T(0);
  }
  ALIGNGS_HD ALIGNGS_ALWAYS_INLINE TermValue<T> at(const TermPixel<T>& p, T weight, T step) const {
    const T inverse_delta = T(1) / delta;
    const bool used = weight > T(0);
    const T z = used ? p.depth : T(1), target = used ? scale * static_cast<T>(p.prior_depth) : T(1);
    const T e = log_of_positive(z / target);
    const T low = e < -delta ? -delta : e, near = low > delta ? delta : low;  // h = near (e - near / 2) / delta
    TermValue<T> out;
    out.value = weight * near * (e - near / T(2)) * inverse_delta;
    out.by_depth = step * weight * near * inverse_delta / z;
    return out;
  }
};

}  // namespace aligngs
