#include "serve/seen_gaussians.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/kept_rows.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr double kReach = 4;  // standard deviations; three are drawn
constexpr double kSpare = 4;  // pixels beside the picture, as each Gaussian is drawn with a least size

/// How far a place is outside of the view, in units of the scene: at most 0 inside.
double outside(const Camera& camera, const Vec3d& p) {
  const double left = (camera.cx + kSpare) / camera.fx, right = (camera.width - camera.cx + kSpare) / camera.fx;
  const double above = (camera.cy + kSpare) / camera.fy, below = (camera.height - camera.cy + kSpare) / camera.fy;
  const auto beyond = [&](double across, double slope) { return (across - slope * p.z) / std::hypot(1.0, slope); };
  return std::max({-p.z, beyond(-p.x, left), beyond(p.x, right), beyond(-p.y, above), beyond(p.y, below)});
}

}  // namespace

GaussianModel seen_gaussians(const GaussianModel& model, const Camera& camera) {
  std::vector<uint8_t> shown(model.size(), 0);
  for (size_t i = 0; i < model.size(); ++i) {
    if (opacity_of(model, i) < kInvisibleOpacity) continue;
    const float* s = &model.log_scales[3 * i];
    const double reach = kReach * std::exp(*std::max_element(s, s + 3));
    shown[i] = outside(camera, camera.world_to_camera * position_of(model, i)) <= reach;
  }
  GaussianModel seen;
  seen.sh_degree = model.sh_degree;
  seen.positions = kept_rows(model.positions, shown, 3);
  seen.log_scales = kept_rows(model.log_scales, shown, 3);
  seen.rotations = kept_rows(model.rotations, shown, 4);
  seen.opacity_logits = kept_rows(model.opacity_logits, shown, 1);
  seen.sh = kept_rows(model.sh, shown, size_t(3) * kShCoefficients);
  return seen;
}

}  // namespace aligngs
