#include "metrics/mesh_culling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace aligngs {
namespace {

constexpr size_t kPointGrain = 1024;  // points per chunk of visibility tests

bool truth_hit_at(const Image<uint8_t>& mask, const Vec2d& uv) {
  return mask.at(static_cast<int>(uv.x), static_cast<int>(uv.y)) != 0;
}

struct Box {
  Vec3d low, high;
  bool contains(const Vec3f& p) const {
    for (int a = 0; a < 3; ++a) {
      if (!(p[a] >= low[a] && p[a] <= high[a])) return false;
    }
    return true;
  }
};

Box scaled_box(const std::vector<Vec3f>& points, double scale) {
  const double inf = std::numeric_limits<double>::infinity();
  Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const Vec3f& p : points) {
    for (int a = 0; a < 3; ++a) {
      box.low[a] = std::min(box.low[a], double(p[a]));
      box.high[a] = std::max(box.high[a], double(p[a]));
    }
  }
  for (int a = 0; a < 3; ++a) {
    const double centre = (box.low[a] + box.high[a]) / 2, half = (box.high[a] - box.low[a]) / 2 * scale;
    box.low[a] = centre - half;
    box.high[a] = centre + half;
  }
  return box;
}

/// In at least one frustum, and on no pixel, of any view, where the truth has no surface.
bool inside_truth_masks(const Vec3f& vertex, const TruthView& view) {
  bool seen = false;
  for (size_t c = 0; c < view.cameras.size(); ++c) {
    const auto uv = project_into_image(view.cameras[c], vertex.cast<double>());
    if (!uv) continue;
    if (!truth_hit_at(view.hit[c], *uv)) return false;
    seen = true;
  }
  return seen;
}

/// `keep(i, hint)` of each point: the hint is 0 at the first of a chunk, and then as the point before left it.
template <class Keep>
std::vector<uint8_t> test_points(size_t points, ThreadPool& pool, const Keep& keep) {
  std::vector<uint8_t> kept(points, 0);
  pool.parallel_for(points, kPointGrain, [&](size_t begin, size_t end, int) {
    size_t hint = 0;
    for (size_t i = begin; i < end; ++i) kept[i] = keep(i, hint);
  });
  return kept;
}

/// Tells cameras that see a point of a surface, and those on whose pixel the truth has none.
class PointVisibility {
 public:
  PointVisibility(const RayScene& rays, const VisibilityTest& test) : rays_(rays), test_(test) {
    for (const Camera& c : test.cameras) eyes_.push_back(c.centre());
  }

  /// As VisibilityTest says. `likely`: the camera to ask first, which is then the one that saw the point. `any`: some
  /// camera sees it.
  bool kept(const Vec3d& point, size_t& likely, uint8_t& any) const {
    // In most rooms truth is everywhere: one camera that sees the point then decides.
    if (!may_miss(point)) {
      any = any_camera_sees(eyes_.size(), likely, [&](size_t c) { return sees(c, point); });
      return any != 0;
    }
    size_t seen = 0, without = 0;
    for (size_t c = 0; c < eyes_.size(); ++c) {
      if (!sees(c, point)) continue;
      ++seen;
      without += missing(c, point);
    }
    any = seen > 0;
    return seen > 0 && static_cast<double>(without) <= test_.options.max_missing_truth * static_cast<double>(seen);
  }

 private:
  bool in_image(size_t camera, const Vec3d& point) const {
    return project_into_image(test_.cameras[camera], point).has_value();
  }
  bool sees(size_t camera, const Vec3d& point) const {
    return in_image(camera, point) && rays_.sees(eyes_[camera], point, test_.options.occlusion_tolerance);
  }
  bool missing(size_t camera, const Vec3d& point) const {
    const auto uv = project_into_image(test_.truth->cameras[camera], point);
    return !uv || !truth_hit_at(test_.truth->hit[camera], *uv);
  }
  /// Whether the truth has none on the pixel of a camera in whose image the point lies.
  bool may_miss(const Vec3d& point) const {
    if (!test_.truth) return false;
    for (size_t c = 0; c < eyes_.size(); ++c) {
      if (in_image(c, point) && missing(c, point)) return true;
    }
    return false;
  }

  const RayScene& rays_;
  const VisibilityTest& test_;
  std::vector<Vec3d> eyes_;
};

PointSet select(const SurfaceSamples& samples, const std::vector<uint8_t>& keep) {
  PointSet set;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    set.positions.push_back(samples.positions[i]);
    set.normals.push_back(samples.normals[i]);
  }
  return set;
}

}  // namespace

std::vector<Camera> ray_cameras(const std::vector<Camera>& cameras, int columns) {
  std::vector<Camera> resized;
  for (const Camera& c : cameras) {
    const int rows = std::max(1, static_cast<int>(std::lround(double(c.height) * columns / c.width)));
    resized.push_back(c.resized(columns, rows));
  }
  return resized;
}

TruthView look_at_truth(const TriangleMesh& truth, HitCache& hits, const std::vector<Camera>& cameras,
                        const std::vector<size_t>& chosen) {
  const std::vector<uint8_t> all(truth.triangles.size(), 1);
  TruthView view;
  for (const size_t c : chosen) {
    view.cameras.push_back(cameras[c]);
    view.hit.push_back(hits.of(c, all).hit);
  }
  view.culled = keep_triangles(truth, hits.seen(chosen, all));
  return view;
}

std::vector<uint8_t> triangles_in_box(const TriangleMesh& mesh, const std::vector<Vec3f>& points, double scale) {
  const Box box = scaled_box(points, scale);
  std::vector<uint8_t> keep(mesh.triangles.size(), 1);
  for (size_t t = 0; t < keep.size(); ++t) {
    for (const uint32_t v : mesh.triangles[t]) keep[t] &= box.contains(mesh.vertices[v]);
  }
  return keep;
}

std::vector<Vec3f> points_where_truth_is(const std::vector<Vec3f>& points, const TruthView& truth, ThreadPool& pool) {
  const std::vector<uint8_t> keep =
      test_points(points.size(), pool, [&](size_t i, size_t&) { return inside_truth_masks(points[i], truth); });
  std::vector<Vec3f> kept;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (keep[i]) kept.push_back(points[i]);
  }
  return kept;
}

VisibleSamples visible_samples(const SurfaceSamples& samples, const RayScene& rays, const VisibilityTest& test,
                               ThreadPool& pool) {
  const PointVisibility visibility(rays, test);
  VisibleSamples visible;
  visible.seen.assign(samples.positions.size(), 0);
  const std::vector<uint8_t> keep = test_points(samples.positions.size(), pool, [&](size_t i, size_t& likely) {
    if (test.seen_by_more && !(*test.seen_by_more)[i]) return false;
    return visibility.kept(samples.positions[i].cast<double>(), likely, visible.seen[i]);
  });
  visible.points = select(samples, keep);
  visible.capped = samples.capped;
  if (!samples.positions.empty()) {
    visible.area = samples.area * static_cast<double>(visible.points.positions.size()) /
                   static_cast<double>(samples.positions.size());
  }
  return visible;
}

}  // namespace aligngs
