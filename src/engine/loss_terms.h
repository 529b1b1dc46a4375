// The values of the loss terms of one step.
#pragma once

namespace aligngs {

/// Unweighted terms; total is the weighted sum.
struct LossTerms {
  double total = 0, l1 = 0, ssim = 0, flatten = 0, semantic_soft = 0, semantic_hard = 0, pearson = 0,
         log_depth = 0, normal_consistency = 0, normal_boundary = 0, crease = 0, prior_normal = 0,
         opacity_l1 = 0, scale_l1 = 0, multi_view_geometric = 0, multi_view_photometric = 0;
  double psnr = 0;  ///< of this view before the step, dB
};

}  // namespace aligngs
