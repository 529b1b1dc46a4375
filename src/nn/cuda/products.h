// Products with matrices of weights, and the operands they need.
#pragma once

#include "device/device_memory.h"
#include "nn/network_device.h"

namespace aligngs::cuda {

/// inputs per step of a product: rows of bfloat16 operands are padded to it, with zeros
constexpr int64_t kDepthStep = 32;

inline int64_t padded_depth(int64_t inputs) { return (inputs + kDepthStep - 1) / kDepthStep * kDepthStep; }

/// y [rows, outputs] = activation(x w^T + bias), sums in float32.
struct ProductSpans {
  int64_t rows = 0, outputs = 0;
  int64_t depth = 0;            ///< elements from row to row of x and w; bfloat16: a multiple of kDepthStep
  const float* bias = nullptr;  ///< [outputs] or null
  nn::Activation activation = nn::Activation::kNone;
  DeviceSpan<float> y;
};
void multiply_bf16(const DeviceContext& context, const ProductSpans& product, DeviceSpan<const uint16_t> x,
                   DeviceSpan<const uint16_t> w);
void multiply_float(const DeviceContext& context, const ProductSpans& product, DeviceSpan<const float> x,
                    DeviceSpan<const float> w);

/// Rows [rows, inputs] as operands, rectified if asked for.
void round_rows(const DeviceContext& context, DeviceSpan<const float> x, int64_t inputs, bool relu,
                DeviceSpan<uint16_t> out);
void relu_rows(const DeviceContext& context, DeviceSpan<const float> x, DeviceSpan<float> out);

/// Patches [places of the output from `first` on][kernel y][kernel x][channels] as operands, zeros outside the map.
void gather_patches(const DeviceContext& context, DeviceSpan<const float> x, const nn::PatchShape& shape, int64_t first,
                    bool relu, DeviceSpan<uint16_t> out);
void gather_patches(const DeviceContext& context, DeviceSpan<const float> x, const nn::PatchShape& shape, int64_t first,
                    bool relu, DeviceSpan<float> out);

}  // namespace aligngs::cuda
