#include "train/free_space.h"
#include "core/is_depth.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr size_t kGrain = 2048;  // Gaussians per task: microseconds each, so that threads share evenly

bool in_front_of_prior(const FreeSpaceView& view, int x, int y, double z, const FreeSpaceRule& rule) {
  if (!view.prior_depth || view.prior_depth->empty()) return false;
  const float raw = view.prior_depth->at(x, y);
  if (!is_depth(raw)) return false;
  if (view.prior_weight && !view.prior_weight->empty() && view.prior_weight->at(x, y) < rule.prior_weight_min)
    return false;
  const double prior = static_cast<double>(raw) * view.prior_scale;
  return z < prior * (1 - rule.prior_relative) - rule.prior_offset;
}

bool in_front_of_rendered(const FreeSpaceView& view, int x, int y, double z, const FreeSpaceRule& rule) {
  if (!view.median_depth || view.median_depth->empty()) return false;
  const float rendered = view.median_depth->at(x, y);
  return is_depth(rendered) && z < rendered * (1 - rule.rendered_relative);
}

bool supports(const FreeSpaceView& view, int x, int y, double z, const FreeSpaceRule& rule) {
  if (!view.median_depth || view.median_depth->empty()) return false;
  int agreeing = 0;
  for (int v = std::max(0, y - 1); v <= std::min(view.camera.height - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(view.camera.width - 1, x + 1); ++u) {
      const float rendered = view.median_depth->at(u, v);
      if (is_depth(rendered) && std::abs(z - rendered) <= rule.agreement * rendered) ++agreeing;
    }
  }
  return agreeing >= rule.support_pixels;
}

}  // namespace

std::vector<uint8_t> free_space_keep(const GaussianModel& model, const std::vector<FreeSpaceView>& views,
                                     const FreeSpaceRule& rule, ThreadPool& pool) {
  std::vector<uint8_t> keep(model.size(), 1);
  pool.parallel_for(model.size(), kGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const float* p = &model.positions[3 * i];
      const Vec3d world{p[0], p[1], p[2]};
      bool floats = false;
      int supporting = 0;
      for (const FreeSpaceView& view : views) {
        const Vec3d c = view.camera.world_to_camera * world;
        if (!(c.z > 0)) continue;
        const Vec2d image = view.camera.project(c);
        if (!view.camera.contains(image)) continue;
        const int x = static_cast<int>(image.x), y = static_cast<int>(image.y);
        floats = floats || in_front_of_prior(view, x, y, c.z, rule) || in_front_of_rendered(view, x, y, c.z, rule);
        if (supports(view, x, y, c.z, rule) && ++supporting >= rule.support_views) break;
      }
      if (floats && supporting < rule.support_views) keep[i] = 0;
    }
  });
  return keep;
}

}  // namespace aligngs
