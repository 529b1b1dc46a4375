// Prior depth in the units of the scene: the factor by which pred_depths/ of each training view is multiplied.
//
// Depth of a network has a scale of its own kind (DepthScale of scene.h). Depth made with these cameras fits them as it
// is. Other depth is laid on what the scene knows: its points, then the depth of views that the points placed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace aligngs {

/// Place of most of a list of log ratios.
struct LogScale {
  double log = 0;     ///< the ratio's logarithm
  double spread = 0;  ///< median of |log ratio - log| over all samples, outliers included
  size_t samples = 0;
};

struct DepthPlacementRule {
  size_t min_samples = 30;  ///< fewer say nothing: the median of 30 depths that are 10 % off is 2 % off
  double outlier = 0.2;     ///< samples whose depth differs by more than this share are other surfaces
};

/// Robust centre: the shortest half of the samples, then twice the median of those within `outlier`. It holds where up
/// to half of the samples are other surfaces, all on one side. Nothing for fewer than rule.min_samples.
std::optional<LogScale> robust_log_scale(std::vector<double> log_ratios, const DepthPlacementRule& rule = {});

enum class PlacedBy {
  kCameras,     ///< it was made with these cameras, or is in metres as the scene is: factor 1
  kPoints,      ///< the scene's points in this view
  kOtherDepth,  ///< depth of other views, carried into this one
  kOtherViews,  ///< the factor of the other views, as nothing in this view tells
  kNothing      ///< not known
};

struct ViewPlacement {
  double factor = 0;  ///< scene units per unit of the map; 0: not known
  PlacedBy by = PlacedBy::kNothing;
  size_t samples = 0;   ///< depths that were compared for the residual
  double residual = 0;  ///< median of |log(factor * depth / reference)| over them; 0 without any
};

struct DepthPlacement {
  DepthScale scale = DepthScale::kScene;
  std::vector<ViewPlacement> views;  ///< in the order of Scene::train
  /// Median over views of their residuals; nothing where no view could be compared with anything.
  std::optional<double> residual;

  size_t count(PlacedBy by) const;
  size_t placed() const;  ///< views with a factor
};

/// Depth of kScene gets factor 1 without being read. Other kinds:
///   kOwn:     one factor, the median of what the views' points say;
/// kMetres:  a factor for every view, near 1 in a metric scene; views about which nothing tells take the median of the
/// others;
///   kPerView: a factor for every view, and none for views about which nothing tells.
/// Reads the maps of all training views. Error{kBadInput} naming a file that cannot be read.
DepthPlacement place_prior_depth(const Scene& scene, const DepthPlacementRule& rule = {});

/// Depth of `views` training views in scene units: factor 1 for each.
DepthPlacement as_given(size_t views);

/// One line for logs and run.json: kind, factor, evidence and residual.
std::string describe(const DepthPlacement& placement);

}  // namespace aligngs
