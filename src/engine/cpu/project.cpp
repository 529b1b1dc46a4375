#include "engine/cpu/project.h"

#include <cmath>

#include "core/error.h"
#include "engine/formulas/color.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kGrain = 512;              ///< rows per task
constexpr float kHalfLog2E = 0.72134752f;   ///< log2(e) / 2: exp(-m / 2) = 2^(-kHalfLog2E m)

bool parameters_finite(const GaussianModel& model, size_t i) {
  float sum = 0;
  for (int k = 0; k < 3; ++k) sum += 0 * model.positions[3 * i + k] + 0 * model.log_scales[3 * i + k];
  for (int k = 0; k < 4; ++k) sum += 0 * model.rotations[4 * i + k];
  for (int k = 0; k < 3 * kShCoefficients; ++k) sum += 0 * model.sh[3 * kShCoefficients * i + k];
  return is_finite(sum + 0 * model.opacity_logits[i]);
}

/// Colour before the clamp at 0, so that a NaN shows.
Vec3<float> raw_color(int degree, const Vec3<float>& direction, const float* sh) {
  float basis[kShCoefficients];
  sh_basis(degree, direction, basis);
  Vec3<float> color{0.5f, 0.5f, 0.5f};
  for (int k = 0; k < sh_coefficient_count(degree); ++k) {
    for (int c = 0; c < 3; ++c) color[c] += sh[3 * k + c] * basis[k];
  }
  return color;
}

Splat make_splat(const Projection<float>& p, const Vec3<float>& color, float alpha_min) {
  Splat s;
  s.x = p.mean.x;
  s.y = p.mean.y;
  s.fxx = std::sqrt(kHalfLog2E * p.conic.xx);
  s.fxy = kHalfLog2E * p.conic.xy / s.fxx;
  s.fyy = std::sqrt(kHalfLog2E / p.covariance.yy);
  s.opacity = p.opacity;
  s.level = std::log2(p.opacity / alpha_min);
  for (int c = 0; c < 3; ++c) {
    s.color[c] = color[c] > 0 ? color[c] : 0.0f;
    s.normal[c] = p.normal[c];
  }
  s.distance = p.distance;
  s.z = p.z;
  s.z_min = p.z_min;
  s.z_max = p.z_max;
  return s;
}

}  // namespace

void project_view(const GaussianModel& model, const Camera& camera, const RasterSettings& raster, int sh_degree,
                  ThreadPool& pool, ProjectedView& view) {
  const size_t n = model.size();
  view.camera = make_projection_camera<float>(camera, raster);
  view.width = camera.width;
  view.height = camera.height;
  view.tiles_x = (camera.width + kTileSize - 1) / kTileSize;
  view.tiles_y = (camera.height + kTileSize - 1) / kTileSize;
  if (view.tiles_x > 65535 || view.tiles_y > 65535) {
    throw Error({ErrorKind::kFailed, "the camera's image is larger than a million pixels on a side", {}, "camera",
                 "render at a smaller size"});
  }
  view.splats.resize(n);
  view.rects.resize(n);
  view.radius.resize(n);
  std::vector<int64_t> non_finite((n + kGrain - 1) / kGrain, -1);
  pool.parallel_for(n, kGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const float *m = &model.positions[3 * i], *s = &model.log_scales[3 * i], *q = &model.rotations[4 * i];
      const GaussianShape<float> shape{{m[0], m[1], m[2]}, {s[0], s[1], s[2]}, {q[0], q[1], q[2], q[3]},
                                       model.opacity_logits[i]};
      Projection<float> p = project(shape, view.camera, raster);
      Vec3<float> color;
      if (p.visible()) {
        color = raw_color(sh_degree, view_direction(shape.position, view.camera.centre),
                          &model.sh[3 * kShCoefficients * i]);
        if (!is_finite(color)) p.status = ProjectionStatus::kNonFinite;
      }
      view.rects[i] = {};
      if (p.status == ProjectionStatus::kNonFinite && !parameters_finite(model, i)) {
        int64_t& first = non_finite[begin / kGrain];
        if (first < 0) first = static_cast<int64_t>(i);
      }
      if (!p.visible()) continue;
      const IntegerRect tiles = tiles_of(p.pixels);
      view.rects[i] = {static_cast<uint16_t>(tiles.x0), static_cast<uint16_t>(tiles.y0),
                       static_cast<uint16_t>(tiles.x1), static_cast<uint16_t>(tiles.y1)};
      view.radius[i] = p.radius;
      view.splats[i] = make_splat(p, color, raster.alpha_min);
    }
  });
  view.non_finite = -1;
  for (const int64_t row : non_finite) {
    if (row >= 0 && view.non_finite < 0) view.non_finite = row;
  }
}

}  // namespace aligngs::cpu
