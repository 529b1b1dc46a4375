#include "engine/cuda/parameter_gradients.h"

#include "engine/cuda/parameter_gradients.cuh"
#include "engine/cuda/runtime/launch.h"

namespace aligngs::cuda {
namespace {

constexpr unsigned kMarkThreads = 256;
constexpr unsigned kSumThreads = 256;

}  // namespace

void mark_touched(const DeviceContext& context, const TileListSpans& lists, const BlendRecordSpans& record,
                  DeviceSpan<uint8_t> touched, DeviceSpan<uint32_t> visible) {
  fill_zero(context, visible);
  launch(context, "mark_touched", mark_touched_kernel, one_per_item(touched.size, kMarkThreads), lists, record, touched,
         visible);
}

size_t square_scratch(size_t gaussians) { return 2 * ((gaussians + kRowThreads - 1) / kRowThreads); }

void parameter_gradients(const DeviceContext& context, const ParameterGradientInputs& in,
                         const ParameterGradientOutputs& out) {
  launch(context, "parameter_gradients", parameter_gradients_kernel, one_per_item(in.model.gaussians, kRowThreads), in,
         out);
  launch(context, "sum_columns", sum_columns_kernel, {dim3(1), dim3(kSumThreads), 0},
         out.scratch.part(0, square_scratch(in.model.gaussians)), 2, 1.0, out.squares);
}

}  // namespace aligngs::cuda
