// A simulated feed-forward reconstruction network: cameras, depth and confidence with its kinds of error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/random.h"
#include "core/thread_pool.h"
#include "synth/shading.h"
#include "synth/world_bend.h"

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

/// Output of the network for one view.
struct TeacherView {
  Camera camera;      ///< pose and focal length with their errors
  ImageF depth;       ///< in the teacher's world units along z; 0 where it says nothing
  ImageF confidence;  ///< >= 1 as VGGT's; rises as the view's own error falls, blind to the world's bend
  ImageF own_error;   ///< |log| of depth over bent true depth: the view's error apart from the bend; for tests
  bool outlier = false;
};

struct GeometryTeacher {
  std::vector<TeacherView> views;
  Similarity world;  ///< true world -> teacher's world, before bend and residuals; identity when metric
};

/// Simulates the network on exact views (in the order of the walk). `centre`, `extent`, `up`: of the room, world
/// frame. The errors of a view depend on the seed and on its own content, never on the truth of other views.
GeometryTeacher simulate_geometry_teacher(const std::vector<RenderedView>& views,
                                          const GeometryTeacherSettings& settings, const Vec3d& centre, double extent,
                                          const Vec3d& up, Random random, ThreadPool& pool);

/// The teacher without errors: exact cameras and depth, confidence 10 everywhere.
GeometryTeacher exact_geometry_teacher(const std::vector<RenderedView>& views);

/// Per pixel: distance in pixels to the nearest depth jump within `radius`, and the depth across it; 0 where there
/// is none. Used to mix depths over edges.
struct DepthJumps {
  ImageF distance, other;
};
DepthJumps find_depth_jumps(const RenderedView& view, int radius);

/// Mixes depths across jumps with a sigmoid of the given width in pixels: flying pixels.
ImageF mix_across_edges(const ImageF& depth, const DepthJumps& jumps, double width);

}  // namespace aligngs
