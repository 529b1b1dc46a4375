#include "scene/camera_path.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "scene/look_at.h"

namespace aligngs {
namespace {

constexpr double kSame = 1e-9;  // of two numbers that are one

/// Eye, target and field of view as numbers that are interpolated alike.
struct Values {
  double v[7];
};

Values values_of(const CameraKey& k) {
  return {{k.eye.x, k.eye.y, k.eye.z, k.target.x, k.target.y, k.target.z, k.fov}};
}

bool same(const Values& a, const Values& b) {
  return std::equal(a.v, a.v + 7, b.v, [](double x, double y) { return std::fabs(x - y) <= kSame; });
}

/// Change a second between two keys.
double slope(const CameraPath& path, size_t from, size_t k) {
  const Values a = values_of(path.keys[from]), b = values_of(path.keys[from + 1]);
  return (b.v[k] - a.v[k]) / (path.keys[from + 1].time - path.keys[from].time);
}

/// Change a second at a key: the mean of the slopes beside it, each weighted by the time of the other.
double tangent(const CameraPath& path, size_t i, size_t k) {
  const size_t last = path.keys.size() - 1;
  const bool loop = last > 1 && same(values_of(path.keys.front()), values_of(path.keys.back()));
  if (!loop && i == 0) return slope(path, 0, k);
  if (!loop && i == last) return slope(path, last - 1, k);
  const size_t before = i == 0 ? last - 1 : i - 1, after = i == last ? 0 : i;
  const double t0 = path.keys[before + 1].time - path.keys[before].time,
               t1 = path.keys[after + 1].time - path.keys[after].time;
  return (slope(path, before, k) * t1 + slope(path, after, k) * t0) / (t0 + t1);
}

}  // namespace

CameraKey key_at(const CameraPath& path, double time) {
  if (time <= path.keys.front().time) return path.keys.front();
  if (time >= path.keys.back().time) return path.keys.back();
  const auto next = std::upper_bound(path.keys.begin(), path.keys.end(), time,
                                     [](double t, const CameraKey& k) { return t < k.time; });
  const size_t i = static_cast<size_t>(next - path.keys.begin()) - 1;
  const double span = path.keys[i + 1].time - path.keys[i].time, s = (time - path.keys[i].time) / span;
  const double h00 = (1 + 2 * s) * (1 - s) * (1 - s), h10 = s * (1 - s) * (1 - s), h01 = s * s * (3 - 2 * s),
               h11 = s * s * (s - 1);
  const Values a = values_of(path.keys[i]), b = values_of(path.keys[i + 1]);
  Values v{};
  for (size_t k = 0; k < 7; ++k)
    v.v[k] = h00 * a.v[k] + h10 * span * tangent(path, i, k) + h01 * b.v[k] + h11 * span * tangent(path, i + 1, k);
  CameraKey out{
      time, {v.v[0], v.v[1], v.v[2]}, {v.v[3], v.v[4], v.v[5]}, std::clamp(v.v[6], kNarrowestView, kWidestView)};
  if (norm(out.target - out.eye) < kShortestSight)
    out.target = out.eye + normalized(path.keys[i].target - path.keys[i].eye);
  return out;
}

CameraPath stretched(CameraPath path, double seconds) {
  const double begin = path.begin(), factor = path.duration() > 0 ? seconds / path.duration() : 1;
  for (CameraKey& key : path.keys) key.time = begin + (key.time - begin) * factor;
  return path;
}

Camera camera_of(const CameraKey& key, const Vec3d& up, int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.5 * height / std::tan(0.5 * key.fov * kRadiansPerDegree);
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  camera.world_to_camera = look_at(key.eye, key.target, up);
  return camera;
}

}  // namespace aligngs
