#include "nn/cuda/map_operators.h"

#include "device/constants.h"
#include "device/launch.h"
#include "nn/cuda/map_operators.cuh"

namespace aligngs::cuda {

void resample_map(const DeviceContext& context, const MapSpans& map, const AxisSpans& vertical,
                  const AxisSpans& horizontal) {
  launch(context, "resample", resample_kernel, one_per_item(map.y.size, kElementThreads), map, vertical, horizontal);
}
void pool_map(const DeviceContext& context, const MapSpans& map, const nn::PatchShape& shape) {
  launch(context, "max_pool", pool_kernel, one_per_item(map.y.size, kElementThreads), map, shape);
}
void depthwise_3x3(const DeviceContext& context, const MapSpans& map, const float* weight, const float* bias) {
  launch(context, "depthwise", depthwise_kernel, one_per_item(map.y.size, kElementThreads), map, weight, bias);
}
void spread_products(const DeviceContext& context, const MapSpans& products, int64_t kernel, const float* bias) {
  launch(context, "spread_products", spread_kernel, one_per_item(products.y.size, kElementThreads), products, kernel,
         bias);
}
void deformable_samples(const DeviceContext& context, const DeformableSpans& spans) {
  launch(context, "deformable", deformable_kernel, one_per_item(spans.out.size, kElementThreads), spans);
}

}  // namespace aligngs::cuda
