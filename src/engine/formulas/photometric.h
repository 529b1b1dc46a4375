// Structural similarity at one pixel of one channel (Wang et al. 2004), and the PSNR.
// SSIM is as splatting papers use it: 11 x 11 Gaussian window with sigma 1.5, zero padding, population moments.
#pragma once

#include <cmath>

#include "core/always_inline.h"
#include "core/host_device.h"

namespace aligngs {

inline constexpr double kPsnrMaximum = 100;  ///< dB; what an exact copy gets, so that logs stay finite
inline constexpr int kSsimTaps = 11;         ///< window size, pixels
inline constexpr int kSsimHalf = kSsimTaps / 2;
inline constexpr double kSsimSigma = 1.5;  ///< pixels
inline constexpr double kSsimC1 = 1e-4;    ///< (0.01 L)^2 for a dynamic range L of 1
inline constexpr double kSsimC2 = 9e-4;    ///< (0.03 L)^2

/// Peak signal-to-noise ratio in dB of a mean squared error of values in [0, 1].
ALIGNGS_HD inline double psnr_of(double mean_squared_error) {
  if (!(mean_squared_error > 0)) return kPsnrMaximum;
  const double psnr = -10 * std::log10(mean_squared_error);
  return psnr < kPsnrMaximum ? psnr : kPsnrMaximum;
}

/// One dimension of the separable window.
template <class T>
struct SsimWindow {
  T tap[kSsimHalf + 1];  ///< tap[k] belongs to offsets +k and -k; the whole window sums to 1
};
template <class T>
inline SsimWindow<T> gaussian_window() {
  double weight[kSsimHalf + 1], sum = 0;
  for (int k = 0; k <= kSsimHalf; ++k) {
    weight[k] = std::exp(-k * k / (2 * kSsimSigma * kSsimSigma));
    sum += k == 0 ? weight[k] : 2 * weight[k];
  }
  SsimWindow<T> window;
  for (int k = 0; k <= kSsimHalf; ++k) window.tap[k] = static_cast<T>(weight[k] / sum);
  return window;
}

/// Weighted means over the window of the render x and the truth y.
template <class T>
struct LocalMoments {
  T x{}, y{}, xx{}, yy{}, xy{};
};
template <class T>
struct SsimSample {
  T value{};
  T d_x{}, d_xx{}, d_xy{};  ///< derivatives by the moments of the render
};

/// With mu_x = E[x], var_x = E[xx] - mu_x^2, cov = E[xy] - mu_x mu_y:
/// S = a1 a2 / (b1 b2), a1 = 2 mu_x mu_y + C1, a2 = 2 cov + C2, b1 = mu_x^2 + mu_y^2 + C1, b2 = var_x + var_y + C2.
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE SsimSample<T> ssim_sample(const LocalMoments<T>& m) {
  const T c1 = static_cast<T>(kSsimC1), c2 = static_cast<T>(kSsimC2);
  const T a1 = T(2) * m.x * m.y + c1, a2 = T(2) * (m.xy - m.x * m.y) + c2;
  const T b1 = m.x * m.x + m.y * m.y + c1, b2 = (m.xx - m.x * m.x) + (m.yy - m.y * m.y) + c2;
  const T inverse = T(1) / (b1 * b2);
  const T s = a1 * a2 * inverse;
  const T s_over_b1 = s * b2 * inverse, s_over_b2 = s * b1 * inverse;
  return {s, T(2) * (m.y * (a2 - a1) * inverse + m.x * (s_over_b2 - s_over_b1)), -s_over_b2, T(2) * a1 * inverse};
}

/// Sum over all windows that hold a pixel of dS / d render there, from the blurred derivatives. The window is
/// symmetric, so the adjoint of the blur is the blur.
template <class T>
ALIGNGS_HD ALIGNGS_ALWAYS_INLINE T ssim_gradient(T d_x, T d_xx, T d_xy, T render, T truth) {
  return d_x + T(2) * render * d_xx + truth * d_xy;
}

}  // namespace aligngs
