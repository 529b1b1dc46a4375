// Levels of the simulated feed-forward network: which network each imitates, and the sizes of its errors.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace aligngs {

/// kMedium imitates VGGT-1B. kBase and kSmall imitate the weaker DA3-Base and DA3-Small, whose cameras and depth err
/// more. Their labels and monocular depth are those of kMedium, since other networks make them.
enum class TeacherLevel { kLow, kMedium, kHigh, kBase, kSmall };
constexpr TeacherLevel kTeacherLevels[] = {TeacherLevel::kLow, TeacherLevel::kMedium, TeacherLevel::kHigh,
                                           TeacherLevel::kBase, TeacherLevel::kSmall};
const char* teacher_level_name(TeacherLevel level);         ///< "low", "medium", "high", "base", "small"
TeacherLevel parse_teacher_level(const std::string& name);  ///< Error{kUsage} for another name

std::vector<std::string> teacher_level_names();  ///< of kTeacherLevels, in that order

/// Published figures of the network that a level imitates (SpatialBench, means over 19 data sets, sparse views).
struct PublishedGeometry {
  const char* network = "";
  double auc_30 = 0;   ///< area under the curve of pair pose errors up to 30 degrees
  double abs_rel = 0;  ///< mean relative error of depth
};
/// Nothing for levels that imitate no network of that table.
std::optional<PublishedGeometry> published_geometry(TeacherLevel level);

/// Error sizes for a metric room of 4 to 6 m. Pose and point errors match those of published feed-forward networks
/// (synth/acceptance.h). A bend of 1.8 cm and 3 degrees was tried first and was too much of both. Misjudged regions
/// give the heavy tail of published figures (mean well above the median). Most of these are shared by all views: with
/// independent ones fusion is too good (TSDF F-score above the accepted range).
struct GeometryTeacherSettings {
  double bend_rms = 0.014;             ///< metres
  double bend_degrees = 2.2;           ///< opposite walls from parallel
  double rotation_degrees = 0.25;      ///< independent residual per camera, root mean square of the angle
  double translation = 0.008;          ///< the same in metres
  double neighbour_correlation = 0.5;  ///< of residuals along the walk
  double outlier_share = 0.03;         ///< of views that are off by 3 to 8 degrees and 10 to 20 cm
  double shared_focal = 0.015;         ///< relative (root mean square of a bounded draw), one for all views
  double view_focal = 0.007;           ///< relative, one draw per view
  double view_scale = 0.008;           ///< relative depth scale per view
  double warp_rms = 0.008;             ///< relative, 4 x 3 bicubic control points per view
  double white = 0.003;                ///< relative, per pixel
  double patch = 0.0015;               ///< relative, per 14-pixel patch of the network's 518-pixel input
  double failure_share = 0.01;         ///< of a view: regions whose depth this view alone misjudges
  double failure_size = 0.10;          ///< relative error there, mean
  double shared_failure_share = 0.26;  ///< of the room: regions that all views misjudge alike
  double shared_failure_size = 0.08;   ///< metres along the surface normal there, mean
  double edge_width = 2.5;             ///< pixels of the image: width of the sigmoid across a depth jump
  bool similarity = false;             ///< unknown scale and rotation of the world as well
};
GeometryTeacherSettings geometry_teacher_settings(TeacherLevel level);

}  // namespace aligngs
