#include "train/smallest_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aligngs {
namespace {

constexpr size_t kScaleGrain = 2048;  // Gaussians per task: microseconds each
constexpr double kMargin = 0.15;      // of the image on each side: what blurs into it is sampled there

/// Pixels per scene unit at a world point; 0: the view does not see it.
double sampling_rate(const GuideView& view, const Vec3d& world) {
  const Vec3d p = view.camera.world_to_camera * world;
  if (!(p.z > view.near_plane)) return 0;
  const Vec2d image = view.camera.project(p);
  const double beside_x = kMargin * view.camera.width, beside_y = kMargin * view.camera.height;
  const bool inside = image.x >= -beside_x && image.y >= -beside_y && image.x < view.camera.width + beside_x &&
                      image.y < view.camera.height + beside_y;
  return inside ? std::max(view.camera.fx, view.camera.fy) / p.z : 0;
}

}  // namespace

std::vector<float> smallest_log_scales(const GaussianModel& model, const std::vector<GuideView>& views, double pixels,
                                       ThreadPool& pool) {
  std::vector<float> out(model.size(), -std::numeric_limits<float>::infinity());
  pool.parallel_for(model.size(), kScaleGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const float* p = &model.positions[3 * i];
      double rate = 0;
      for (const GuideView& view : views) rate = std::max(rate, sampling_rate(view, {p[0], p[1], p[2]}));
      if (rate > 0) out[i] = static_cast<float>(std::log(pixels / rate));
    }
  });
  return out;
}

}  // namespace aligngs
