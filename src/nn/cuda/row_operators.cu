#include "nn/cuda/row_operators.h"

#include "device/constants.h"
#include "device/launch.h"
#include "nn/cuda/row_operators.cuh"

namespace aligngs::cuda {
namespace {

LaunchShape warp_per_row(int64_t rows) { return one_per_item(size_t(rows) * 32, kElementThreads); }

}  // namespace

void normalise_rows(const DeviceContext& context, const RowSpans& spans, const float* weight, const float* bias,
                    float eps) {
  launch(context, "normalise_rows", normalise_kernel, warp_per_row(spans.rows), spans, weight, bias, eps);
}
void softmax(const DeviceContext& context, const RowSpans& spans) {
  launch(context, "softmax", softmax_kernel, warp_per_row(spans.rows), spans);
}
void activate(const DeviceContext& context, const RowSpans& spans, const float* bias, nn::Activation activation) {
  launch(context, "activate", activate_kernel, one_per_item(spans.y.size, kElementThreads), spans, bias, activation);
}
void gated_silu(const DeviceContext& context, const RowSpans& spans) {
  launch(context, "gated_silu", gated_silu_kernel, one_per_item(spans.y.size, kElementThreads), spans);
}
void accumulate(const DeviceContext& context, const RowSpans& spans, const float* bias, const float* scale,
                bool rectified) {
  launch(context, "accumulate", accumulate_kernel, one_per_item(spans.y.size, kElementThreads), spans, bias, scale,
         rectified);
}
void scale_and_shift(const DeviceContext& context, const RowSpans& spans, const float* scale, const float* shift,
                     bool relu) {
  launch(context, "scale_and_shift", scale_kernel, one_per_item(spans.y.size, kElementThreads), spans, scale, shift,
         relu);
}
void group_statistics(const DeviceContext& context, const RowSpans& spans, const GroupStatistics& statistics) {
  launch(context, "group_statistics", group_kernel,
         {dim3(static_cast<unsigned>(statistics.groups)), dim3(kElementThreads)}, spans, statistics);
}
void prepare_head_rows(const DeviceContext& context, const HeadSpans& spans) {
  if (spans.heads.q_weight == nullptr && spans.heads.cosines == nullptr) return;
  launch(context, "prepare_heads", head_kernel, warp_per_row(spans.heads.rows * 2 * spans.heads.heads), spans);
}
void copy_block(const DeviceContext& context, const BlockCopy& copy) {
  launch(context, "copy_block", copy_kernel, one_per_item(size_t(copy.rows * copy.columns), kElementThreads), copy);
}

}  // namespace aligngs::cuda
