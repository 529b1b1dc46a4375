#include "engine/cuda/semantic_rows.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/semantic_rows.cuh"

namespace aligngs::cuda {
namespace {

LaunchShape one_warp_per_row(size_t rows) {
  return {dim3(static_cast<unsigned>((rows + kRowWarps - 1) / kRowWarps)), dim3(kRowWarps * kWarp), 0};
}

}  // namespace

void semantic_rows(const DeviceContext& context, const SemanticRowInputs& in, DeviceSpan<uint16_t> rows) {
  launch(context, "semantic_rows", semantic_rows_kernel, one_warp_per_row(in.model.gaussians), in, rows);
}

void semantic_gradients(const DeviceContext& context, const SemanticGradientInputs& in,
                        const SemanticGradientOutputs& out) {
  launch(context, "semantic_gradients", semantic_gradients_kernel, one_warp_per_row(in.rows.model.gaussians), in, out);
}

}  // namespace aligngs::cuda
