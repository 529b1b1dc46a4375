#include "synth/view_planner.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "synth/synth_purpose.h"

namespace aligngs {
namespace {

constexpr int kSurfacePoints = 2500;  // samples of the room's surface by which views are judged

}  // namespace

ViewPlanner::ViewPlanner(const RoomRays& s, const TrajectoryOptions& o, ThreadPool& p)
    : scene(s), options(o), pool(p), walkable(s.room()), random(stream_of(Random(o.seed), SynthPurpose::kTrajectory)) {
  up = s.room().room_to_world.rotation.column(2);
  sample_surface();
}

Vec3d ViewPlanner::world(const Vec2d& floor, double height) const {
  return scene.room().room_to_world * Vec3d{floor.x, floor.y, height};
}

Camera ViewPlanner::camera(const Rigidd& pose) const {
  Camera c;
  c.width = options.width;
  c.height = options.height;
  c.fx = c.fy = options.width / 2.0 / std::tan(options.horizontal_fov_degrees * kPi / 360);
  c.cx = options.width / 2.0;
  c.cy = options.height / 2.0;
  c.world_to_camera = pose;
  return c;
}

void ViewPlanner::sample_surface() {
  const RoomModel& room = scene.room();
  std::vector<double> cumulative;
  double total = 0;
  for (size_t t = 0; t < room.triangles.size(); ++t) cumulative.push_back(total += room.triangle_area(t));
  std::vector<Vec3d> eyes;
  const auto& places = walkable.camera_places();
  for (int i = 0; i < 30; ++i) {
    const Vec2d p = places[static_cast<size_t>(random.below(static_cast<int>(places.size())))];
    eyes.push_back(world(p, random.uniform(1.1, 1.7)));
  }
  for (int i = 0; i < 2 * kSurfacePoints && static_cast<int>(points.size()) < kSurfacePoints; ++i) {
    const double at = random.uniform(0, total);
    const size_t t =
        static_cast<size_t>(std::lower_bound(cumulative.begin(), cumulative.end(), at) - cumulative.begin());
    const auto& tri = room.triangles[std::min(t, room.triangles.size() - 1)];
    const Vec3d a = room.positions[tri[0]].cast<double>(), b = room.positions[tri[1]].cast<double>(),
                c = room.positions[tri[2]].cast<double>();
    const Vec3d n = normalized(cross(b - a, c - a));
    const Vec3d p = (a + b + c) * (1.0 / 3) + n * 0.003;
    int seen = 0;
    for (const Vec3d& eye : eyes) seen += dot(eye - p, n) > 0.1 * norm(eye - p) && scene.visible(eye, p, 0.005) ? 1 : 0;
    if (seen < 3) continue;
    points.push_back(p);
    normals.push_back(n);
  }
}

std::vector<uint8_t> ViewPlanner::visible_from(const Vec3d& eye) const {
  std::vector<uint8_t> out(points.size(), 0);
  pool.parallel_for(points.size(), 256, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3d d = eye - points[i];
      out[i] = dot(d, normals[i]) > 0.12 * norm(d) && scene.visible(eye, points[i], 0.005);
    }
  });
  return out;
}

double ViewPlanner::clearance(const Vec3d& eye) const {
  double nearest = 1e9;
  for (int i = 0; i < 27; ++i) {
    const Vec3d d{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
    if (norm(d) == 0) continue;
    const RayHit hit = scene.intersect(eye, normalized(d));
    if (hit.hit) nearest = std::min(nearest, hit.distance);
  }
  return nearest;
}

}  // namespace aligngs
