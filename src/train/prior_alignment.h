// The scale a_v of each view's metric prior depth in L_z.
#pragma once

#include <optional>

#include "core/image.h"
#include "scene/camera.h"
#include "scene/point_cloud.h"

namespace aligngs {

struct PriorAlignmentRule {
  double limit = 0.03;       ///< |a_v - 1| is clamped to this: the prior has one scale, views deviate little
  size_t min_samples = 100;  ///< fewer pixels or points determine nothing
  double outlier = 0.2;      ///< samples whose depth differs by more than this share are other surfaces
};

/// exp(median log(reference / prior)) over pixels where both have a value, clamped to [1 - limit, 1 + limit]: the
/// closed-form minimiser of the absolute log difference over one scale. Nothing below min_samples. `prior` and
/// `reference` are H x W x 1 of the same size, 0 or non-finite = no value. `weight` may be empty (1 everywhere). Pixels
/// of weight 0 are left out.
std::optional<float> align_prior_to_depth(const ImageF& prior, const ImageF& weight, const ImageF& reference,
                                          const PriorAlignmentRule& rule);

/// The same against the depths of 3-D points that project into the view. Occluded points differ by more than
/// `outlier` and are left out.
std::optional<float> align_prior_to_points(const ImageF& prior, const ImageF& weight, const Camera& camera,
                                           const PointCloud& cloud, const PriorAlignmentRule& rule);

/// The scale of depth about which nothing is known: the robust centre of log(reference / prior) over such pixels
/// (robust_log_scale of scene/depth_placement.h), without limits. Nothing below rule.min_samples.
std::optional<float> find_prior_scale(const ImageF& prior, const ImageF& weight, const ImageF& reference,
                                      const PriorAlignmentRule& rule);

}  // namespace aligngs
