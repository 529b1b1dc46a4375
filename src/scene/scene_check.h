// The parts of checking a scene: headers first, then pixels, then what the geometry says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/view_data.h"

namespace aligngs {

/// Missing files and headers that contradict the scene, of the training and test views; nothing is decoded.
std::vector<SceneProblem> check_headers(const Scene& scene);

/// Error{kBadInput} with all reasons when so many views were left out that fewer than kFewestTrainingViews train.
void require_enough_training_views(const Scene& scene);

/// Whether a map given as depth is disparity (larger is nearer) or has another unit, judged on the scene's points.
struct DisparityEvidence {
  int points = 0;               ///< visible points with a prior value
  double rank_correlation = 0;  ///< Spearman's, of prior value and depth of the points
  double ratio = 1;             ///< median of prior value / depth; 1 for fewer than 30 points
  bool is_enough() const;       ///< at least 30 points
  bool is_disparity() const;    ///< enough points and a correlation below -0.5
  bool has_other_unit() const;  ///< a ratio above 3 or below a third
};
DisparityEvidence disparity_evidence(const PointCloud& cloud, const Camera& camera, const ImageF& prior_depth);

/// The way in which a map is turned against its photo ("upside down"), where its depth fits the points only then; else
/// nothing. Nothing either where larger values are nearer throughout, as in disparity.
std::optional<std::string> turned_map(const PointCloud& cloud, const Camera& camera, const ImageF& prior_depth);

/// SceneProblem::field of the warning about depth that contradicts cameras or points (depth_contradiction.h). An importer,
/// which has asked the same of the depth before, leaves it out.
inline constexpr const char* kDepthOfViews = "depth of the views";

/// At most one warning: the depth of the training views together contradicts cameras, points or the size of rooms.
std::vector<SceneProblem> check_depth_of_views(const Scene& scene);

/// Warnings from cameras and points alone: views that see few points or share few with any other view, cameras
/// that are (nearly) in one place. A single training view is one as well.
std::vector<SceneProblem> check_geometry(const Scene& scene);

/// Indices of the points that project into the image, less those clearly behind others (a coarse depth test).
std::vector<uint32_t> visible_points(const PointCloud& cloud, const Camera& camera);

}  // namespace aligngs
