// Places from which a person with a phone takes pictures of a room, and test views near to and far from them.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/thread_pool.h"
#include "synth/raytracer.h"

namespace aligngs {

struct TrajectoryOptions {
  int training_views = 20;
  int test_views = 8;  ///< the first half interpolates between training views, the second half does not
  int width = 320, height = 240;
  double horizontal_fov_degrees = 68;  ///< a phone's main camera
  uint64_t seed = 1;
};

/// Why a view exists.
enum class ViewRole : uint8_t {
  kTraining,
  kTestNear,  ///< between two neighbouring training views
  kTestFar,   ///< >= 0.5 m or >= 30 degrees from every training view, but looks at what they saw
};

struct PlannedView {
  Camera camera;  ///< exact pose, in the frame of the room's positions (the world)
  ViewRole role = ViewRole::kTraining;
};

/// Limits that make a test view "far": it must pass one of them against every training view.
inline constexpr double kFarMetres = 0.5;
inline constexpr double kFarDegrees = 30;
/// Least share of a test view's pixels that some training view saw as well.
inline constexpr double kSeenShare = 0.9;

/// Views in the order of the walk (training and near test views), then the far test views. Eye height 1.1 to
/// 1.7 m; directions are chosen so that most of the surface is seen by two training views or more.
/// Throws Error{kFailed} when the room has no free floor.
std::vector<PlannedView> plan_views(const RoomRays& scene, const TrajectoryOptions& options, ThreadPool& pool);

/// Whether `camera` sees the world point: in the image, in front, not hidden. `slack`: metres of tolerance.
bool camera_sees(const RoomRays& scene, const Camera& camera, const Vec3d& point, double slack = 0.02);

}  // namespace aligngs
