#include "synth/trajectory.h"

#include <algorithm>

#include "core/error.h"
#include "synth/test_views.h"
#include "synth/training_views.h"
#include "synth/view_planner.h"

namespace aligngs {

bool camera_sees(const RoomRays& scene, const Camera& camera, const Vec3d& point, double slack) {
  const Vec3d q = camera.world_to_camera * point;
  if (q.z <= 0.05 || !camera.contains(camera.project(q))) return false;
  return scene.visible(camera.centre(), point, slack);
}

std::vector<PlannedView> plan_views(const RoomRays& scene, const TrajectoryOptions& options, ThreadPool& pool) {
  ViewPlanner planner(scene, options, pool);
  const std::vector<Station> training = plan_training(planner);
  const int far_wanted = options.test_views / 2, near_wanted = options.test_views - far_wanted;
  std::vector<Camera> far = plan_far(planner, training, far_wanted);
  // If a room has no place that is far and yet seen, further views near the path take the missing ones.
  const int missing = far_wanted - static_cast<int>(far.size());
  std::vector<NearView> near = plan_near(planner, training, near_wanted + missing);
  if (near.size() + far.size() < static_cast<size_t>(options.test_views)) {
    throw Error({ErrorKind::kFailed,
                 "the walk leaves no place for the test views",
                 {},
                 {},
                 "use more training views or another seed"});
  }
  std::vector<PlannedView> views;
  for (size_t i = 0; i < training.size(); ++i) {
    views.push_back({training[i].camera, ViewRole::kTraining});
    for (const NearView& n : near) {
      if (n.after == i) views.push_back({n.camera, ViewRole::kTestNear});
    }
  }
  for (const Camera& c : far) views.push_back({c, ViewRole::kTestFar});
  return views;
}

}  // namespace aligngs
