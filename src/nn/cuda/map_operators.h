// Operators on maps: resampling, pooling, depthwise convolution, deformable samples.
#pragma once

#include "device/device_memory.h"
#include "nn/network_device.h"

namespace aligngs::cuda {

struct MapSpans {
  DeviceSpan<const float> x;
  DeviceSpan<float> y;
  int64_t height = 0, width = 0, channels = 0;  ///< of x
};

/// An axis of a resampling on the device (nn/ops/resize.h).
struct AxisSpans {
  DeviceSpan<const int> first, index;
  DeviceSpan<const float> weight;
  int64_t outputs() const { return int64_t(first.size) - 1; }
};
void resample_map(const DeviceContext& context, const MapSpans& map, const AxisSpans& vertical,
                  const AxisSpans& horizontal);
void pool_map(const DeviceContext& context, const MapSpans& map, const nn::PatchShape& shape);
void depthwise_3x3(const DeviceContext& context, const MapSpans& map, const float* weight, const float* bias);
/// x: products [places][kernel][kernel][channels of y].
void spread_products(const DeviceContext& context, const MapSpans& products, int64_t kernel, const float* bias);

struct DeformableSpans {
  int64_t queries = 0, heads = 0, head_dim = 0, points = 0, levels = 0, reference_levels = 1;
  DeviceSpan<const float> reference, offsets, attention, values;
  DeviceSpan<const int> sizes;  ///< height, width per level
  DeviceSpan<float> out;
};
void deformable_samples(const DeviceContext& context, const DeformableSpans& spans);

}  // namespace aligngs::cuda
