// The Pearson correlation of rendered and prior depth (AlignGS, Gao et al. 2025), from the sums over the pixels. It
// needs their means before it can compare them, so engines have loops of their own for it.
#pragma once

#include <cmath>

#include "core/host_device.h"

namespace aligngs {

inline constexpr double kPearsonMinimumShare = 0.05;  ///< of the pixels must be valid: fewer say little
/// standard deviation / mean of the prior: a flat one correlates with noise
inline constexpr double kPearsonMinimumSpread = 0.05;
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
