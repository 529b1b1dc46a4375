#include "synth/training_views.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "scene/look_at.h"

namespace aligngs {
namespace {

std::vector<uint32_t> points_in_view(const ViewPlanner& p, const Station& s, const Camera& camera) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < p.points.size(); ++i) {
    if (!s.visible[i]) continue;
    const Vec3d q = camera.world_to_camera * p.points[i];
    if (q.z > 0.3 && camera.contains(camera.project(q))) out.push_back(i);
  }
  return out;
}

/// Worth of the count-th sight of a point: two views matter most, a third helps.
double worth(int count) {
  static constexpr double kWorth[] = {1.0, 0.9, 0.35, 0.15};
  return count < 4 ? kWorth[count] : 0.04;
}

std::vector<Camera> direction_candidates(const ViewPlanner& p, const Vec3d& eye, Random& random) {
  std::vector<Camera> out;
  const Mat3d& axes = p.scene.room().room_to_world.rotation;
  const double offset = random.uniform(0, 15);
  for (int yaw = 0; yaw < 24; ++yaw) {
    for (const double pitch : {-27.0, -16.0, -7.0, 3.0}) {
      const double a = (yaw * 15 + offset) * kPi / 180, b = (pitch + random.uniform(-3, 3)) * kPi / 180;
      const Vec3d forward = axes * Vec3d{std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)};
      out.push_back(p.camera(look_at(eye, eye + forward, p.up, random.uniform(-1.5, 1.5))));
    }
  }
  return out;
}

}  // namespace

std::vector<Station> plan_training(ViewPlanner& p) {
  const auto& places = p.walkable.camera_places();
  const std::vector<Vec2d> walk =
      p.walkable.walk(p.options.training_views, static_cast<size_t>(p.random.below(static_cast<int>(places.size()))));
  std::vector<Station> stations;
  double height = p.random.uniform(1.3, 1.5);
  for (const Vec2d& at : walk) {
    Station s;
    height = std::clamp(height + p.random.uniform(-0.18, 0.18), 1.1, 1.7);
    s.eye = p.world(at, height);
    // Not with the phone against a shelf: move to a freer place when something is within a hand's width.
    for (int attempt = 0; attempt < 40 && p.clearance(s.eye) < 0.22; ++attempt) {
      const Vec2d q = places[static_cast<size_t>(p.random.below(static_cast<int>(places.size())))];
      if (std::hypot(q.x - at.x, q.y - at.y) < 0.2 + 0.03 * attempt) s.eye = p.world(q, height);
    }
    s.visible = p.visible_from(s.eye);
    stations.push_back(std::move(s));
  }
  // Coordinate ascent on the directions: each view in turn takes the direction that adds most to the others.
  std::vector<int> count(p.points.size(), 0);
  for (int sweep = 0; sweep < 3; ++sweep) {
    for (Station& s : stations) {
      for (const uint32_t i : s.seen) --count[i];
      double best = -1;
      std::vector<uint32_t> best_seen;
      for (const Camera& candidate : direction_candidates(p, s.eye, p.random)) {
        const std::vector<uint32_t> seen = points_in_view(p, s, candidate);
        double gain = 0, distance = 0;
        int shared = 0;
        for (const uint32_t i : seen) {
          gain += worth(count[i]);
          distance += norm(p.points[i] - s.eye);
          shared += count[i] > 0 ? 1 : 0;
        }
        if (seen.empty()) continue;
        distance /= static_cast<double>(seen.size());
        // A picture from very near shows one object and shares little; after the first sweep views must overlap.
        gain *= std::clamp(distance / 1.6, 0.2, 1.0);
        if (sweep > 0) gain *= std::clamp(shared / (0.7 * static_cast<double>(seen.size())), 0.2, 1.0);
        if (gain > best) {
          best = gain;
          s.camera = candidate;
          best_seen = seen;
        }
      }
      s.seen = std::move(best_seen);
      for (const uint32_t i : s.seen) ++count[i];
    }
  }
  return stations;
}

}  // namespace aligngs
