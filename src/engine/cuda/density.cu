// Kernel of density.h: one thread per row.
#include "engine/cuda/density.h"

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"
#include "engine/formulas/whitened.h"

namespace aligngs::cuda {

__device__ __forceinline__ float planar_length(float x, float y) { return std::sqrt(x * x + y * y); }

__global__ void __launch_bounds__(kRowThreads) density_kernel(DensityInputs in, DensitySpans to) {
  const size_t i = item_index();
  if (i >= in.touched.size || in.touched[i] == 0) return;
  if (!in.blocked.empty() && in.blocked[0] != 0) return;
  const DensitySums d = in.sums[i];
  const Splat& s = in.view.splats[i];
  const float to_ndc_x = 0.5f * in.view.width, to_ndc_y = 0.5f * in.view.height;
  const Vec2<float> mean =
      whitened_mean_gradient(WhiteningFactor<float>{s.fxx, s.fxy, s.fyy}, d.photometric_p, d.photometric_r);
  const float absolute_x = float(kTwoLn2) * s.fxx * d.photometric_abs_p;
  const float absolute_y = float(kTwoLn2) * d.photometric_abs_y;
  to.gradient[i] += planar_length(mean.x * to_ndc_x, mean.y * to_ndc_y);
  to.gradient_abs[i] += planar_length(absolute_x * to_ndc_x, absolute_y * to_ndc_y);
  to.visible[i] += 1.0f;
  const float radius = in.view.radius[i], largest = to.radius[i];
  to.radius[i] = radius > largest ? radius : largest;
  to.weight[i] += d.weight;
  to.residual[i] += d.residual;
  to.unsupported[i] += d.unsupported;
}

void add_density_statistics(const DeviceContext& context, const DensityInputs& in, const DensitySpans& statistics) {
  launch(context, "density", density_kernel, one_per_item(in.touched.size, kRowThreads), in, statistics);
}

}  // namespace aligngs::cuda
