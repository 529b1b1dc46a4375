#include "synth/test_views.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "scene/look_at.h"

namespace aligngs {
namespace {

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

ViewContent content_of(const ViewPlanner& p, const Camera& view, const std::vector<Station>& training) {
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

}  // namespace

std::vector<NearView> plan_near(const ViewPlanner& p, const std::vector<Station>& training, int count) {
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

std::vector<Camera> plan_far(ViewPlanner& p, const std::vector<Station>& training, int count) {
  const auto& places = p.walkable.camera_places();
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

}  // namespace aligngs
