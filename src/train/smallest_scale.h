// The smallest scale that any photo can distinguish from a point. It is the 3-D smoothing filter of Mip-Splatting (Yu
// et al., CVPR 2024) as a hard limit.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "train/training_set.h"

namespace aligngs {

/// Per Gaussian the natural logarithm of `pixels` of the training view that sees it sharpest (focal length / depth),
/// scene units. Minus infinity if no view sees it. A view sees everything beyond its near plane and in its image, or up
/// to 15 % of it beside, as there.
std::vector<float> smallest_log_scales(const GaussianModel& model, const std::vector<GuideView>& views, double pixels,
                                       ThreadPool& pool);

}  // namespace aligngs
