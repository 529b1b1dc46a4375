// The values of the losses of one step.
#pragma once

#include "engine/loss_catalogue.h"

namespace aligngs {

/// Unweighted values by loss; total is their weighted sum.
struct LossTerms {
  double total = 0;
  PerLoss<double> values;
  double psnr = 0;  ///< of this view before the step, dB

  ALIGNGS_HD double& operator[](Loss loss) { return values[loss]; }
  ALIGNGS_HD double operator[](Loss loss) const { return values[loss]; }
  /// Adds an unweighted value, and its share of the total.
  ALIGNGS_HD void add(Loss loss, float weight, double value) {
    values[loss] += value;
    total += weight * value;
  }
};

}  // namespace aligngs
