// Noise on the places of nearly transparent Gaussians, so that they look for something to do (3DGS-MCMC, Kheradmand et
// al., NeurIPS 2024, equation 8). Alike on every engine.
#pragma once

#include <cmath>

#include "core/quaternion.h"
#include "engine/formulas/index_hash.h"

namespace aligngs {

/// The noise of one step; a rate of 0 changes nothing.
struct PositionNoise {
  /// learning rate of positions times the strength, scene units^-1 (the covariance has squares of them)
  float rate = 0;
  uint64_t seed = 0;  ///< draws it
};

/// 1 for transparent Gaussians, 1/2 at an opacity of 0.005, nothing from a few per cent on.
inline constexpr float kNoiseSteepness = 100, kNoiseOpacity = 0.005f;
/// Beyond this opacity the noise is less than 1e-8 of that of a transparent Gaussian.
inline constexpr float kNoiseOpacityMax = 0.2f;

/// Two independent standard normal numbers (Box and Muller) of a seed and an index.
ALIGNGS_HD inline void normal_pair(uint64_t seed, size_t index, float& a, float& b) {
  using std::cos;
  using std::log;
  using std::sin;
  using std::sqrt;
  const uint64_t bits = index_hash(seed, index);
  const float u = (static_cast<float>(bits >> 40) + 1.0f) * 0x1p-24f;  // in (0, 1]
  const float v = static_cast<float>((bits >> 16) & 0xffffff) * 0x1p-24f;
  const float radius = sqrt(-2.0f * log(u)), angle = 6.28318531f * v;
  a = radius * cos(angle);
  b = radius * sin(angle);
}

/// The addition to the position of row i: rate * gate(opacity) * covariance * N(0, 1).
ALIGNGS_HD inline Vec3<float> position_noise(const PositionNoise& noise, size_t row, float opacity,
                                             const float* log_scales, const float* rotation) {
  using std::exp;
  if (!(opacity < kNoiseOpacityMax)) return {};
  float n[4];
  normal_pair(noise.seed, 2 * row, n[0], n[1]);
  normal_pair(noise.seed, 2 * row + 1, n[2], n[3]);
  const Mat3<float> r =
      rotation_matrix(normalized(Quaternion<float>{rotation[0], rotation[1], rotation[2], rotation[3]}));
  Vec3<float> local = transpose(r) * Vec3<float>{n[0], n[1], n[2]};
  for (int k = 0; k < 3; ++k) local[k] *= exp(2.0f * log_scales[k]);
  const float gate = 1.0f / (1.0f + exp(kNoiseSteepness * (opacity - kNoiseOpacity)));
  return (noise.rate * gate) * (r * local);
}

}  // namespace aligngs
