// Sums per (Gaussian, tile) on the way back from the maps, the same in both engines.
#pragma once

#include <cstddef>

namespace aligngs {

/// Sums over pixels that one Gaussian receives from one tile. g is dL/dpower of a pixel, and (p, r) = F^T (dx, dy) is
/// its whitened offset (formulas/whitened.h). The moments of g give mean, conic and opacity. They are kept in whitened
/// form because the moments of (dx, dy) cancel for needles.
struct alignas(16) SplatGradient {
  float color[3];
  float weight;  ///< sum of w
  float normal[3];
  float distance;
  float p, r, one, pp;  ///< sums of g p, g r, g, g p^2: losses of the maps
  float pr, rr;
  float residual;                              ///< sum of w * colour residual
  float unsupported;                           ///< sum of w where the prior depth does not support this Gaussian
  float photometric_p, photometric_r;          ///< sums of g p, g r of the colour losses alone
  float photometric_abs_p, photometric_abs_y;  ///< sums of |g p| and |g (fxy p + fyy r)|
};
inline constexpr int kSplatGradientFloats = sizeof(SplatGradient) / sizeof(float);
static_assert(kSplatGradientFloats == 20, "five vectors of four");

/// Places in SplatGradient, as numbers.
enum SplatSum : int {
  kSumColor = 0,
  kSumWeight = 3,
  kSumNormal = 4,
  kSumDistance = 7,
  kSumP = 8,
  kSumR,
  kSumOne,
  kSumPp,
  kSumPr,
  kSumRr,
  kSumResidual,
  kSumUnsupported,
  kSumPhotometricP,
  kSumPhotometricR,
  kSumPhotometricAbsP,
  kSumPhotometricAbsY
};
static_assert(kSumPhotometricAbsY + 1 == kSplatGradientFloats);
static_assert(offsetof(SplatGradient, p) == kSumP * sizeof(float) &&
              offsetof(SplatGradient, rr) == kSumRr * sizeof(float));
static_assert(offsetof(SplatGradient, photometric_p) == kSumPhotometricP * sizeof(float));

/// Places behind them of the same moments of the semantic coupling, where both are in one row.
enum CouplingSum : int {
  kSumCouplingP = kSplatGradientFloats,
  kSumCouplingR,
  kSumCouplingOne,
  kSumCouplingPp,
  kSumCouplingPr,
  kSumCouplingRr,
  kCoupledSums
};

/// Sums of a Gaussian over its tiles that density control needs; see SplatGradient.
struct DensitySums {
  float photometric_p, photometric_r, photometric_abs_p, photometric_abs_y, weight, residual, unsupported;
};

}  // namespace aligngs
