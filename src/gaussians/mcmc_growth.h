// Growth as in 3DGS-MCMC (Kheradmand et al., NeurIPS 2024): dead Gaussians move to where opaque ones are, and their
// number rises to a cap. An alternative to density_control.h.
#pragma once

#include <cstddef>

#include "gaussians/density_control.h"

namespace aligngs {

struct McmcRule {
  float dead_opacity = 0;     ///< up to this a Gaussian is dead
  double growth = 1;          ///< number after a call / before, until the cap
  size_t max_gaussians = 0;   ///< cap; 0: the number stays
  bool morton_order = false;  ///< the plan's rows in the order of morton_order.h
};

/// Shape of `copies` equal Gaussians in one place, so that together they look nearly as one of opacity `opacity` did
/// (there, equation 9).
struct SharedShape {
  double opacity;  ///< of each
  double shrink;   ///< scales are divided by this
};
SharedShape shared_shape(double opacity, int copies);

/// Dead rows go; as many copies, and 5 % of new ones, of living rows drawn in proportion to their opacity come behind.
/// Rows that were drawn change with their copies and lose their moments. Random numbers are drawn only for copies. No
/// living row: everything stays.
RestructurePlan plan_mcmc_growth(const GaussianModel& model, const McmcRule& rule, Random& random);

}  // namespace aligngs
