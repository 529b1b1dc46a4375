#include "engine/cuda/shape_terms.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/shape_terms.cuh"

namespace aligngs::cuda {

void add_shape_terms(DeviceArena& arena, const ShapeTermInputs& in, const ShapeTermOutputs& out) {
  const LossSettings& s = in.settings;
  if (!s.has(LossStage::kShape)) return;
  const LaunchShape shape = one_per_item(in.model.gaussians, kRowThreads);
  const DeviceSpan<double> partial = arena.take<double>(shape.grid.x * size_t(kShapeSums), "sums of the shape terms");
  launch(arena.context(), "shape_terms", shape_terms_kernel, shape, in, out, partial);
  launch(arena.context(), "finish_shape_terms", finish_shape_terms_kernel, {dim3(1), dim3(kSumThreads), 0}, in, partial,
         out.terms);
}

}  // namespace aligngs::cuda
