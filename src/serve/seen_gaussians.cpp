#include "serve/seen_gaussians.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr double kReach = 4;  // standard deviations; three are drawn
constexpr double kSpare = 4;  // pixels beside the picture, as each Gaussian is drawn with a least size

void append(std::vector<float>& to, const std::vector<float>& from, size_t row, size_t width) {
  const auto begin = from.begin() + static_cast<ptrdiff_t>(row * width);
  to.insert(to.end(), begin, begin + static_cast<ptrdiff_t>(width));
}

/// How far a place is outside of the view, in units of the scene: at most 0 inside.
double outside(const Camera& camera, const Vec3d& p) {
  const double left = (camera.cx + kSpare) / camera.fx, right = (camera.width - camera.cx + kSpare) / camera.fx;
  const double above = (camera.cy + kSpare) / camera.fy, below = (camera.height - camera.cy + kSpare) / camera.fy;
  const auto beyond = [&](double across, double slope) { return (across - slope * p.z) / std::hypot(1.0, slope); };
  return std::max({-p.z, beyond(-p.x, left), beyond(p.x, right), beyond(-p.y, above), beyond(p.y, below)});
}

}  // namespace

GaussianModel seen_gaussians(const GaussianModel& model, const Camera& camera) {
  GaussianModel seen;
  seen.sh_degree = model.sh_degree;
  for (size_t i = 0; i < model.size(); ++i) {
    if (opacity_of(model, i) < kInvisibleOpacity) continue;
    const float* s = &model.log_scales[3 * i];
    if (outside(camera, camera.world_to_camera * position_of(model, i)) >
        kReach * std::exp(*std::max_element(s, s + 3)))
      continue;
    append(seen.positions, model.positions, i, 3);
    append(seen.log_scales, model.log_scales, i, 3);
    append(seen.rotations, model.rotations, i, 4);
    append(seen.opacity_logits, model.opacity_logits, i, 1);
    append(seen.sh, model.sh, i, size_t(3) * kShCoefficients);
  }
  return seen;
}

}  // namespace aligngs
