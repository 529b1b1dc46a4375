// Operators on rows of floats: normalisations, softmax, activations, sums, the heads of attention.
#pragma once

#include "device/device_memory.h"
#include "nn/network_device.h"

namespace aligngs::cuda {

struct RowSpans {
  DeviceSpan<const float> x;
  DeviceSpan<float> y;  ///< may be x
  int64_t rows = 0, columns = 0;
};

/// Null weights count as 1 and 0.
void normalise_rows(const DeviceContext& context, const RowSpans& spans, const float* weight, const float* bias,
                    float eps);
void softmax(const DeviceContext& context, const RowSpans& spans);
/// y = activation(x + bias).
void activate(const DeviceContext& context, const RowSpans& spans, const float* bias, nn::Activation activation);
/// y[r, c] = silu(x[r, c]) * x[r, columns + c]: x has 2 * columns per row.
void gated_silu(const DeviceContext& context, const RowSpans& spans);
/// y += scale * (x + bias); x and y have the same shape; rectified: max(x, 0) in its place.
void accumulate(const DeviceContext& context, const RowSpans& spans, const float* bias, const float* scale,
                bool rectified);
/// y = x * scale + shift per column.
void scale_and_shift(const DeviceContext& context, const RowSpans& spans, const float* scale, const float* shift,
                     bool relu);

/// scale and shift per column that normalise each group of columns over all rows.
struct GroupStatistics {
  int64_t groups = 1;
  const float *weight = nullptr, *bias = nullptr;
  double eps = 0;
  DeviceSpan<float> scale, shift;
};
void group_statistics(const DeviceContext& context, const RowSpans& spans, const GroupStatistics& statistics);

/// The prepared places lie on the device: y, x of each token.
struct HeadSpans {
  nn::HeadPreparation heads;
  DeviceSpan<const int> places;
  DeviceSpan<float> qkv;
};
void prepare_head_rows(const DeviceContext& context, const HeadSpans& spans);

struct BlockCopy {
  DeviceSpan<const float> from;
  DeviceSpan<float> to;
  int64_t from_stride = 0, to_stride = 0, rows = 0, columns = 0;
  bool add = false;
};
void copy_block(const DeviceContext& context, const BlockCopy& copy);

}  // namespace aligngs::cuda
