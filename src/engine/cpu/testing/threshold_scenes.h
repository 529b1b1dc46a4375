// Scenes for the thresholds of blending: Gaussians placed near one, and the removal of those that are there by chance.
// Float and double may take the latter differently without either being wrong.
#pragma once

#include <vector>

#include "engine/engine_arrays.h"
#include "engine/testing/scenes.h"
#include "gaussians/restructure.h"

namespace aligngs::cpu::testing_scene {

/// A Gaussian on the centre of a pixel, of the low-pass' size alone (0.55 pixels), so that its alpha there is its
/// opacity.
struct Dot {
  int x = 0, y = 0;    ///< pixel
  double depth = 0.5;  ///< of the camera, scene units
  double opacity = 0.5;
};

inline double opacity_of(float logit) { return 1 / (1 + std::exp(-static_cast<double>(logit))); }
inline float logit_of(double opacity) { return static_cast<float>(std::log(opacity / (1 - opacity))); }

/// The dots, coloured and labelled as make_model does, before the rows of `behind`.
inline GaussianModel with_dots(const std::vector<Dot>& dots, const RandomSceneOptions& o, GaussianModel behind) {
  RandomSceneOptions front = o;
  front.gaussians = dots.size();
  front.seed = o.seed + 50;
  GaussianModel m = make_model(front);
  const Camera camera = make_camera(o.width, o.height);
  const Rigidd to_world = camera.world_to_camera.inverse();
  for (size_t i = 0; i < dots.size(); ++i) {
    const Vec3d p = to_world * (camera.ray(dots[i].x + 0.5, dots[i].y + 0.5) * dots[i].depth);
    for (int k = 0; k < 3; ++k) m.positions[3 * i + k] = static_cast<float>(p[k]);
    for (int k = 0; k < 3; ++k) m.log_scales[3 * i + k] = -12;
    m.opacity_logits[i] = logit_of(dots[i].opacity);
  }
  const std::vector<NamedArray> from = arrays_of(behind), to = arrays_of(m);
  for (size_t k = 0; k < to.size(); ++k)
    to[k].values->insert(to[k].values->end(), from[k].values->begin(), from[k].values->end());
  return m;
}

/// How close to a threshold counts as beside it, relative to the threshold. The mean of a Gaussian is some 1e-5 pixels
/// off in float. The alpha of one a pixel wide moves by as much of itself.
inline constexpr double kThresholdMargin = 1e-4;
/// The same for two depths, whose order decides which is in front: some ten roundings of a float.
inline constexpr double kDepthMargin = 2e-6;

/// Flags of rows whose part in some pixel, or whose place in the order, hangs on rounding.
inline std::vector<uint8_t> beside_a_threshold(const GaussianModel& model, const Camera& camera,
                                               const RasterSettings& raster) {
  const auto s = reference::make_splats(to_double(model), camera, raster, 0);
  const double alpha_min = static_cast<double>(raster.alpha_min), alpha_max = static_cast<double>(raster.alpha_max);
  const double left_min = static_cast<double>(raster.transmittance_min);
  const auto beside = [](double value, double threshold) {
    return std::abs(value - threshold) < kThresholdMargin * threshold;
  };
  std::vector<uint8_t> flags(model.size(), 0);
  for (size_t k = 1; k < s.order.size(); ++k) {
    const double z = s.projections[s.order[k]].z, nearer = s.projections[s.order[k - 1]].z;
    if (z - nearer < kDepthMargin * z) flags[s.order[k]] = 1;
  }
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      double left = 1;
      for (const uint32_t row : s.order) {
        const Projection<double>& p = s.projections[row];
        const double dx = x + 0.5 - p.mean.x, dy = y + 0.5 - p.mean.y;
        const double power = -0.5 * (p.conic.xx * dx * dx + p.conic.yy * dy * dy) - p.conic.xy * dx * dy;
        const double raw = p.opacity * std::exp(power), next = left * (1 - std::min(raw, alpha_max));
        if (beside(raw, alpha_min) || beside(raw, alpha_max)) flags[row] = 1;
        if (raw < alpha_min) continue;
        if (beside(next, left_min)) flags[row] = 1;
        if (next < left_min) break;
        left = next;
      }
    }
  }
  return flags;
}

/// The model without them. Removing one changes what is left behind it, so this goes on until none is found.
inline GaussianModel away_from_thresholds(GaussianModel model, const Camera& camera, const RasterSettings& raster) {
  for (;;) {
    std::vector<uint8_t> keep = beside_a_threshold(model, camera, raster);
    size_t removed = 0;
    for (uint8_t& flag : keep) {
      removed += flag;
      flag = flag != 0 ? 0 : 1;
    }
    if (removed == 0) return model;
    restructure_model(plan_keep(keep), model);
  }
}

}  // namespace aligngs::cpu::testing_scene
