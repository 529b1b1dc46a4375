#include "refine/sensor_depth.h"

#include <algorithm>
#include <cmath>

#include "core/is_depth.h"

namespace aligngs {
namespace {

/// Steps between depths that no surface makes which the sensor could measure.
class SurfaceSteps {
 public:
  SurfaceSteps(const Camera& camera, double flattest)
      : slope_(std::sqrt(1 - flattest * flattest) / flattest), focal_(std::min(camera.fx, camera.fy)) {}

  /// Whether depths `pixels` apart lie on one surface; false where one has none.
  bool joined(float a, float b, int pixels) const {
    return is_depth(a) && is_depth(b) && std::abs(a - b) <= pixels * std::min(a, b) / focal_ * slope_;
  }

 private:
  double slope_, focal_;
};

/// Depth `step` pixels away in x or y; 0 outside.
float depth_beside(const ImageF& depth, int x, int y, bool along_x, int step) {
  const int u = along_x ? x + step : x, v = along_x ? y : y + step;
  return u < 0 || v < 0 || u >= depth.width || v >= depth.height ? 0.0f : depth.at(u, v);
}

/// Apart from both neighbours of its row, or of its column. A neighbour without depth does not count as one, but two
/// such say nothing.
bool is_mixed(const ImageF& depth, int x, int y, const SurfaceSteps& steps) {
  for (const bool along_x : {true, false}) {
    const float z = depth.at(x, y), before = depth_beside(depth, x, y, along_x, -1),
                after = depth_beside(depth, x, y, along_x, 1);
    if (!is_depth(before) && !is_depth(after)) continue;
    if (!steps.joined(before, z, 1) && !steps.joined(z, after, 1)) return true;
  }
  return false;
}

Vec3d point_at(const Camera& camera, int x, int y, float z) { return camera.ray(x + 0.5, y + 0.5) * double(z); }

/// The surface around a pixel, from the pixels `span` to either side. No normal where it breaks off.
bool normal_around(const Camera& camera, const ImageF& depth, int x, int y, int span, const SurfaceSteps& steps,
                   Vec3d& normal) {
  const float z = depth.at(x, y);
  Vec3d along[2];
  for (const bool along_x : {true, false}) {
    const float before = depth_beside(depth, x, y, along_x, -span), after = depth_beside(depth, x, y, along_x, span);
    if (!steps.joined(before, z, span) || !steps.joined(z, after, span)) return false;
    const int dx = along_x ? span : 0, dy = along_x ? 0 : span;
    along[along_x ? 0 : 1] = point_at(camera, x + dx, y + dy, after) - point_at(camera, x - dx, y - dy, before);
  }
  normal = normalized(cross(along[1], along[0]));  // towards the camera
  return true;
}

/// Whether a surface near the pixel rises from it towards the camera's side, and its light comes over it.
bool is_in_corner(const Camera& camera, const ImageF& depth, int x, int y, int span, double concave,
                  const SurfaceSteps& steps, const Vec3d& normal) {
  const Vec3d here = point_at(camera, x, y, depth.at(x, y));
  for (const bool along_x : {true, false}) {
    for (const int reach : {-3 * span, 3 * span}) {
      const float z = depth_beside(depth, x, y, along_x, reach);
      if (!is_depth(z) || !steps.joined(depth.at(x, y), z, 3 * span)) continue;
      const Vec3d there = point_at(camera, along_x ? x + reach : x, along_x ? y : y + reach, z);
      if (dot(normal, there - here) > concave * norm(there - here)) return true;
    }
  }
  return false;
}

bool is_doubtful(const Camera& camera, const ImageF& depth, const ImageF& luma, int x, int y,
                 const SensorDepthSettings& s, const SurfaceSteps& steps) {
  if (luma.at(x, y) < s.dark) return true;
  Vec3d normal;
  if (!normal_around(camera, depth, x, y, s.span, steps, normal)) return false;
  const Vec3d ray = camera.ray(x + 0.5, y + 0.5);
  if (std::abs(dot(normal, ray)) < s.glancing * norm(ray)) return true;
  return is_in_corner(camera, depth, x, y, s.span, s.concave, steps, normal);
}

}  // namespace

SensorDepth clean_sensor_depth(const Camera& camera, const ImageF& depth, const ImageF* confidence, const ImageF& luma,
                               const SensorDepthSettings& settings) {
  SensorDepth out;
  out.depth = ImageF(depth.width, depth.height, 1);
  out.confidence = ImageF(depth.width, depth.height, 1);
  const SurfaceSteps steps(camera, settings.flattest);
  size_t measured = 0, mixed = 0, doubtful = 0;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      if (!is_depth(depth.at(x, y))) continue;
      ++measured;
      if (is_mixed(depth, x, y, steps)) {
        ++mixed;
        continue;
      }
      const bool doubt = is_doubtful(camera, depth, luma, x, y, settings, steps);
      doubtful += doubt ? 1 : 0;
      out.depth.at(x, y) = depth.at(x, y);
      out.confidence.at(x, y) = (confidence != nullptr ? confidence->at(x, y) : 1.0f) *
                                (doubt ? static_cast<float>(settings.doubtful_share) : 1.0f);
    }
  }
  if (measured > 0) {
    out.mixed = static_cast<double>(mixed) / static_cast<double>(measured);
    out.doubtful = static_cast<double>(doubtful) / static_cast<double>(measured);
  }
  return out;
}

}  // namespace aligngs
