#include "synth/trajectory.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/error.h"
#include "scene/look_at.h"
#include "synth/free_space.h"

namespace aligngs {
namespace {

constexpr int kSurfacePoints = 2500;  // samples of the room's surface by which views are judged

/// Everything the planning steps share.
struct Planner {
  const RoomRays& scene;
  const TrajectoryOptions& options;
  ThreadPool& pool;
  FreeSpace space;
  Random random;
  Vec3d up;                            // world
  std::vector<Vec3d> points, normals;  // on the surface, world

  Planner(const RoomRays& s, const TrajectoryOptions& o, ThreadPool& p)
      : scene(s), options(o), pool(p), space(s.room()), random(Random(o.seed).fork(41)) {
    up = s.room().room_to_world.rotation.column(2);
    sample_surface();
  }

  Vec3d world(const Vec2d& floor, double height) const {
    return scene.room().room_to_world * Vec3d{floor.x, floor.y, height};
  }

  Camera camera(const Rigidd& pose) const {
    Camera c;
    c.width = options.width;
    c.height = options.height;
    c.fx = c.fy = options.width / 2.0 / std::tan(options.horizontal_fov_degrees * kPi / 360);
    c.cx = options.width / 2.0;
    c.cy = options.height / 2.0;
    c.world_to_camera = pose;
    return c;
  }

  /// Points by area, kept when they can be seen from somewhere a camera can be.
  void sample_surface() {
    const RoomModel& room = scene.room();
    std::vector<double> cumulative;
    double total = 0;
    for (size_t t = 0; t < room.triangles.size(); ++t) cumulative.push_back(total += room.triangle_area(t));
    std::vector<Vec3d> eyes;
    const auto& places = space.camera_places();
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
      for (const Vec3d& eye : eyes)
        seen += dot(eye - p, n) > 0.1 * norm(eye - p) && scene.visible(eye, p, 0.005) ? 1 : 0;
      if (seen < 3) continue;
      points.push_back(p);
      normals.push_back(n);
    }
  }

  /// Per surface point: whether the eye sees it, from any direction.
  std::vector<uint8_t> visible_from(const Vec3d& eye) const {
    std::vector<uint8_t> out(points.size(), 0);
    pool.parallel_for(points.size(), 256, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3d d = eye - points[i];
        out[i] = dot(d, normals[i]) > 0.12 * norm(d) && scene.visible(eye, points[i], 0.005);
      }
    });
    return out;
  }

  /// Distance from the eye to the nearest surface in 26 directions.
  double clearance(const Vec3d& eye) const {
    double nearest = 1e9;
    for (int i = 0; i < 27; ++i) {
      const Vec3d d{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
      if (norm(d) == 0) continue;
      const RayHit hit = scene.intersect(eye, normalized(d));
      if (hit.hit) nearest = std::min(nearest, hit.distance);
    }
    return nearest;
  }
};

struct Station {
  Vec3d eye;
  std::vector<uint8_t> visible;
  Camera camera;
  std::vector<uint32_t> seen;  // indices of points in the chosen view
};

std::vector<uint32_t> points_in_view(const Planner& p, const Station& s, const Camera& camera) {
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

std::vector<Camera> direction_candidates(const Planner& p, const Vec3d& eye, Random& random) {
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

std::vector<Station> plan_training(Planner& p) {
  const auto& places = p.space.camera_places();
  const std::vector<Vec2d> walk =
      p.space.walk(p.options.training_views, static_cast<size_t>(p.random.below(static_cast<int>(places.size()))));
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

Rigidd between(const Camera& a, const Camera& b, double t, const Vec3d& eye) {
  // Normalised linear blend of the quaternions: the two are at most some 60 degrees apart.
  const Quaterniond qa = quaternion_of(a.world_to_camera.rotation);
  Quaterniond qb = quaternion_of(b.world_to_camera.rotation);
  if (qa.w * qb.w + qa.x * qb.x + qa.y * qb.y + qa.z * qb.z < 0) qb = {-qb.w, -qb.x, -qb.y, -qb.z};
  const Quaterniond q = normalized(Quaterniond{qa.w + (qb.w - qa.w) * t, qa.x + (qb.x - qa.x) * t,
                                               qa.y + (qb.y - qa.y) * t, qa.z + (qb.z - qa.z) * t});
  const Mat3d r = rotation_matrix(q);
  return {r, -(r * eye)};
}

/// Content of a possible test view, from a grid of 32 x 24 rays.
struct ViewContent {
  double seen = 0;      ///< share of its surface that at least one training view sees
  int objects = 0;      ///< that fill 1 % of it or more
  double distance = 0;  ///< mean, metres
};

ViewContent content_of(const Planner& p, const Camera& view, const std::vector<Station>& training) {
  constexpr int kColumns = 32, kRows = 24;
  const Rigidd pose = view.world_to_camera.inverse();
  std::vector<uint8_t> seen(kColumns * kRows, 0);
  std::vector<int> object(seen.size(), -1);
  std::vector<double> distance(seen.size(), 0);
  p.pool.parallel_for(seen.size(), 32, [&](size_t begin, size_t end, int) {
    for (size_t k = begin; k < end; ++k) {
      const Vec3d ray = view.ray((static_cast<double>(k % kColumns) + 0.5) * view.width / kColumns,
                                 (static_cast<double>(k / kColumns) + 0.5) * view.height / kRows);
      const Vec3d d = pose.rotation * ray;
      const RayHit h = p.scene.intersect(pose.translation, d);
      if (!h.hit) continue;
      object[k] = p.scene.room().triangle_object[h.triangle];
      distance[k] = h.distance;
      const Vec3d point = pose.translation + d * h.distance;
      for (const Station& s : training) {
        if (!camera_sees(p.scene, s.camera, point)) continue;
        seen[k] = 1;
        break;
      }
    }
  });
  ViewContent content;
  std::vector<int> pixels(p.scene.room().objects.size(), 0);
  int hits = 0;
  for (size_t k = 0; k < seen.size(); ++k) {
    if (object[k] < 0) continue;
    ++hits;
    content.seen += seen[k];
    content.distance += distance[k];
    content.objects += ++pixels[static_cast<size_t>(object[k])] == static_cast<int>(seen.size() / 100) ? 1 : 0;
  }
  if (hits > 0) content.seen /= hits, content.distance /= hits;
  return content;
}

double turn_between(const Camera& a, const Camera& b) {
  return rotation_angle_between_degrees(a.world_to_camera.rotation, b.world_to_camera.rotation);
}

struct NearView {
  size_t after = 0;  // comes after this training view in the walk
  Camera camera;
};

std::vector<NearView> plan_near(const Planner& p, const std::vector<Station>& training, int count) {
  struct Pair {
    size_t a, b;
    double cost;
  };
  std::vector<Pair> pairs;
  for (size_t a = 0; a < training.size(); ++a) {
    for (size_t b = a + 1; b < training.size(); ++b) {
      const double metres = norm(training[a].eye - training[b].eye),
                   turn = turn_between(training[a].camera, training[b].camera);
      pairs.push_back({a, b, metres + turn / 40});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
  std::vector<NearView> out;
  std::vector<uint8_t> used(training.size(), 0);
  for (const bool distinct : {true, false}) {  // first pairs that share no view, then any
    for (const Pair& pair : pairs) {
      if (static_cast<int>(out.size()) >= count) return out;
      if (distinct && (used[pair.a] || used[pair.b])) continue;
      const double t = distinct ? 0.5 : 0.35;
      const Vec3d eye = training[pair.a].eye * (1 - t) + training[pair.b].eye * t;
      if (p.clearance(eye) < 0.12) continue;
      const Camera camera = p.camera(between(training[pair.a].camera, training[pair.b].camera, t, eye));
      if (content_of(p, camera, training).seen < kSeenShare + 0.02) continue;
      used[pair.a] = used[pair.b] = 1;
      out.push_back({pair.a, camera});
    }
  }
  return out;
}

std::vector<Camera> plan_far(Planner& p, const std::vector<Station>& training, int count) {
  const auto& places = p.space.camera_places();
  struct Candidate {
    Camera camera;
    double novelty, interest;
  };
  std::vector<Candidate> good;
  for (int i = 0; i < 3000 && static_cast<int>(good.size()) < 20 * count; ++i) {
    const Vec2d at = places[static_cast<size_t>(p.random.below(static_cast<int>(places.size())))];
    const Vec3d eye = p.world(at, p.random.uniform(1.1, 1.7));
    const Vec3d target = p.points[static_cast<size_t>(p.random.below(static_cast<int>(p.points.size())))];
    const Vec3d d = target - eye;
    const double lift = dot(normalized(d), p.up), roll = p.random.uniform(-1.5, 1.5);
    if (norm(d) < 1.5 || lift > 0.15 || lift < -0.55) continue;
    const Camera camera = p.camera(look_at(eye, target, p.up, roll));
    double novelty = 1e9;
    for (const Station& s : training) {
      novelty =
          std::min(novelty, std::max(norm(s.eye - eye) / kFarMetres, turn_between(s.camera, camera) / kFarDegrees));
    }
    if (novelty < 1.02 || p.clearance(eye) < 0.22) continue;
    const ViewContent content = content_of(p, camera, training);
    if (content.seen < kSeenShare + 0.02) continue;
    // Nobody photographs an empty wall: views with furniture, from across the room, come first.
    good.push_back({camera, novelty, std::min(1.0, content.objects / 7.0) * std::min(1.0, content.distance / 2.2)});
  }
  std::vector<Camera> out;
  while (static_cast<int>(out.size()) < count && !good.empty()) {
    size_t best = 0;
    double best_score = -1;
    for (size_t i = 0; i < good.size(); ++i) {
      double score = std::min(good[i].novelty, 2.0);  // and unlike the test views chosen so far
      for (const Camera& c : out) {
        score = std::min(score, norm(c.centre() - good[i].camera.centre()) + turn_between(c, good[i].camera) / 60);
      }
      score *= good[i].interest;
      if (score > best_score) best_score = score, best = i;
    }
    out.push_back(good[best].camera);
    good.erase(good.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return out;
}

}  // namespace

bool camera_sees(const RoomRays& scene, const Camera& camera, const Vec3d& point, double slack) {
  const Vec3d q = camera.world_to_camera * point;
  if (q.z <= 0.05 || !camera.contains(camera.project(q))) return false;
  return scene.visible(camera.centre(), point, slack);
}

std::vector<PlannedView> plan_views(const RoomRays& scene, const TrajectoryOptions& options, ThreadPool& pool) {
  Planner planner(scene, options, pool);
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
