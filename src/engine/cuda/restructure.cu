// Kernels of restructure.h.
#include "engine/cuda/restructure.h"

#include <cmath>
#include <vector>

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"

namespace aligngs::cuda {

/// out[row] = in[source[row]], or zero where only kept rows count. One thread per number.
__global__ void __launch_bounds__(kRowThreads) gather_rows(DevicePlan::Spans plan, size_t width, bool kept_only,
                                                           DeviceSpan<const float> in, DeviceSpan<float> out) {
  const size_t i = item_index();
  if (i >= out.size) return;
  const size_t row = i / width, column = i % width;
  out[i] = kept_only && plan.kept[row] == 0 ? 0.0f : in[plan.source[row] * width + column];
}

__global__ void __launch_bounds__(kRowThreads) move_new_rows(DevicePlan::Spans plan, ModelSpans model) {
  const size_t i = item_index();
  if (i >= model.gaussians || plan.kept[i] != 0) return;
  for (size_t k = 0; k < 3; ++k) {
    model.positions[3 * i + k] += plan.offset[3 * i + k];
    model.log_scales[3 * i + k] -= plan.log_shrink[i];
  }
  const float logit = plan.opacity_logit[i];
  if (logit == logit) model.opacity_logits[i] = logit;
}
namespace {

void gather(const DeviceContext& context, const DevicePlan& plan, size_t width, bool kept_only,
            DeviceSpan<const float> in, DeviceSpan<float> out) {
  launch(context, "gather_rows", gather_rows, one_per_item(out.size, kRowThreads), plan.spans(), width, kept_only, in,
         out);
}

/// One array at a time: never more than one of them twice in memory.
void gather_array(DeviceContext& context, const DevicePlan& plan, size_t width, bool kept_only,
                  DeviceArray<float>& array) {
  DeviceArray<float> next(context, plan.rows() * width, "the restructured model");
  if (width > 0) gather(context, plan, width, kept_only, array.span(), next.span());
  array.swap(next);
}

void gather_arrays(DeviceContext& context, const DevicePlan& plan, bool kept_only, ModelArrays& arrays) {
  arrays.for_each([&](DeviceArray<float>& a, size_t width) { gather_array(context, plan, width, kept_only, a); });
}

}  // namespace

DevicePlan::DevicePlan(DeviceContext& context, const RestructurePlan& plan) {
  const size_t n = plan.rows.size();
  std::vector<uint32_t> source(n);
  std::vector<uint8_t> kept(n);
  std::vector<float> offset(3 * n), log_shrink(n), opacity_logit(n);
  for (size_t i = 0; i < n; ++i) {
    const RowOrigin& row = plan.rows[i];
    source[i] = row.source;
    kept[i] = row.kind == RowOrigin::Kind::kKeep;
    for (size_t k = 0; k < 3; ++k) offset[3 * i + k] = row.offset[k];
    opacity_logit[i] = row.opacity_logit;
    log_shrink[i] = row.kind == RowOrigin::Kind::kSplit ? std::log(row.shrink) : 0.0f;
  }
  source_.assign(context, source, "a plan of density control");
  kept_.assign(context, kept, "a plan of density control");
  offset_.assign(context, offset, "a plan of density control");
  log_shrink_.assign(context, log_shrink, "a plan of density control");
  opacity_logit_.assign(context, opacity_logit, "a plan of density control");
}

void restructure_model(DeviceContext& context, const DevicePlan& plan, ModelArrays& model) {
  gather_arrays(context, plan, false, model);
  launch(context, "move_new_rows", move_new_rows, one_per_item(plan.rows(), kRowThreads), plan.spans(), model.spans());
}

void restructure_moment(DeviceContext& context, const DevicePlan& plan, ModelArrays& moment) {
  gather_arrays(context, plan, true, moment);
}

void restructure_numbers(DeviceContext& context, const DevicePlan& plan, DeviceArray<float>& numbers) {
  gather_array(context, plan, 1, true, numbers);
}

}  // namespace aligngs::cuda
