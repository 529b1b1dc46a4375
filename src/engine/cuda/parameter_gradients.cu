#include "engine/cuda/parameter_gradients.h"

#include "device/constants.h"
#include "engine/cuda/parameter_gradients.cuh"
#include "engine/cuda/sum_columns.cuh"

namespace aligngs::cuda {

void mark_touched(const DeviceContext& context, const TileListSpans& lists, const BlendRecordSpans& record,
                  DeviceSpan<uint8_t> touched, DeviceSpan<uint32_t> visible) {
  fill_zero(context, visible);
  launch(context, "mark_touched", mark_touched_kernel, one_per_item(touched.size, kRowThreads), lists, record, touched,
         visible);
}

size_t square_scratch(size_t gaussians) { return 2 * ((gaussians + kGradientThreads - 1) / kGradientThreads); }

void parameter_gradients(const DeviceContext& context, const ParameterGradientInputs& in,
                         const ParameterGradientOutputs& out) {
  launch(context, "parameter_gradients", parameter_gradients_kernel, one_per_item(in.model.gaussians, kGradientThreads),
         in, out);
  sum_columns<2>(context, out.scratch.part(0, square_scratch(in.model.gaussians)), 1.0, out.squares);
}

}  // namespace aligngs::cuda
