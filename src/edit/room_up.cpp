#include "edit/room_up.h"

#include "core/log.h"
#include "scene/up_direction.h"

namespace aligngs {

std::optional<Vec3d> up_of_room(const Scene& scene, const LabelledGaussians& gaussians) {
  if (scene.up) return scene.up;
  std::vector<ViewUp> views;
  for (const int i : scene.train) views.push_back(view_up(scene.views[static_cast<size_t>(i)].camera.world_to_camera));
  std::vector<Vec3d> floor, points;
  const int floor_class = scene.labels.find("floor");
  const std::vector<float>& positions = gaussians.model.positions;
  for (size_t i = 0; floor_class >= 0 && i < gaussians.labels.label.size() && 3 * i + 2 < positions.size(); ++i) {
    if (gaussians.labels.label[i] == floor_class)
      floor.push_back({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
  }
  for (const Vec3f& p : scene.cloud.positions) points.push_back(p.cast<double>());
  const auto up = estimate_up(views, floor, points);
  if (!up) return std::nullopt;
  log_debug("up is ({:.3f}, {:.3f}, {:.3f}), by {}", up->direction.x, up->direction.y, up->direction.z, up->source);
  return up->direction;
}

}  // namespace aligngs
