// Kernel of project.h: one thread per row.
#include "engine/cuda/project.h"

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/formulas/color.h"
#include "engine/formulas/whitened.h"

namespace aligngs::cuda {

__device__ __forceinline__ GaussianShape<float> load_shape(const ModelSpans& m, size_t i) {
  const float *p = m.positions.data + 3 * i, *s = m.log_scales.data + 3 * i;
  const float4 q = *reinterpret_cast<const float4*>(m.rotations.data + 4 * i);
  return {{p[0], p[1], p[2]}, {s[0], s[1], s[2]}, {q.x, q.y, q.z, q.w}, m.opacity_logits.data[i]};
}

__device__ inline bool row_is_finite(const GaussianShape<float>& g, const float* sh) {
  const float rotation = g.rotation.w + g.rotation.x + g.rotation.y + g.rotation.z;
  bool finite = is_finite(g.position) && is_finite(g.log_scale) && is_finite(rotation) && is_finite(g.opacity_logit);
  for (int k = 0; k < 3 * kShCoefficients; ++k) finite &= is_finite(sh[k]);
  return finite;
}

__global__ void __launch_bounds__(kRowThreads)
    project_rows(ProjectInputs in, ViewSpans view, DeviceSpan<unsigned long long> bad) {
  const size_t i = item_index();
  if (i >= in.model.gaussians) return;
  view.rects[i] = TileRect{};
  const GaussianShape<float> g = load_shape(in.model, i);
  const Projection<float> p = project(g, view.camera, in.raster);
  const float* sh = in.model.sh.data + size_t(3) * kShCoefficients * i;
  if (!p.visible()) {
    if (p.status == ProjectionStatus::kNonFinite && !row_is_finite(g, sh)) {
      atomicMin(&bad[0], bad_gradient_key(i, GradientClass::kPositions));
    }
    return;
  }
  const WhiteningFactor<float> f = whitening_factor(p);
  const Vec3<float> color = sh_color(in.sh_degree, view_direction(g.position, view.camera.centre), sh);
  // max(0, NaN) is 0: what hides behind the clamp is seen in the coefficients.
  float used = 0;
  for (int k = 0; k < 3 * sh_coefficient_count(in.sh_degree); ++k) used += sh[k];
  if (!is_finite(used) || !is_finite(color)) {
    if (!row_is_finite(g, sh)) atomicMin(&bad[0], bad_gradient_key(i, GradientClass::kPositions));
    return;
  }
  if (in.raster.dropout.drops(i) || !is_finite(f.xx) || !is_finite(f.xy) || !is_finite(f.yy)) return;
  Splat s;
  s.x = p.mean.x;
  s.y = p.mean.y;
  s.fxx = f.xx;
  s.fxy = f.xy;
  s.fyy = f.yy;
  s.opacity = p.opacity;
  s.level = std::log2(p.opacity / in.raster.alpha_min);
  for (int k = 0; k < 3; ++k) {
    s.color[k] = color[k];
    s.normal[k] = p.normal[k];
  }
  s.distance = p.distance;
  s.z = p.z;
  s.z_min = p.z_min;
  s.z_max = p.z_max;
  s.slot_stride = 0;
  s.slot_origin = 0;
  view.splats[i] = s;
  view.radius[i] = p.radius;
  const IntegerRect tiles = tiles_of(p.pixels);
  view.rects[i] = {static_cast<uint16_t>(tiles.x0), static_cast<uint16_t>(tiles.y0), static_cast<uint16_t>(tiles.x1),
                   static_cast<uint16_t>(tiles.y1)};
}

void project_view(const DeviceContext& context, const ProjectInputs& in, const ViewSpans& view,
                  DeviceSpan<unsigned long long> bad) {
  launch(context, "project_rows", project_rows, one_per_item(in.model.gaussians, kRowThreads), in, view, bad);
}

}  // namespace aligngs::cuda
