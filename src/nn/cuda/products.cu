#include "nn/cuda/products.h"

#include "device/constants.h"
#include "device/launch.h"
#include "nn/cuda/products.cuh"

namespace aligngs::cuda {
namespace {

template <int kWarpsM, int kWarpsN, int kTilesM, int kTilesN>
void launch_bf16(const DeviceContext& context, const ProductSpans& p, DeviceSpan<const uint16_t> x,
                 DeviceSpan<const uint16_t> w) {
  using Shape = ProductBlock<kWarpsM, kWarpsN, kTilesM, kTilesN>;
  const auto blocks = [](int64_t n, int64_t size) { return static_cast<unsigned>((n + size - 1) / size); };
  launch(context, "product_bf16", product_bf16_kernel<kWarpsM, kWarpsN, kTilesM, kTilesN>,
         {dim3(blocks(p.outputs, Shape::kColumns), blocks(p.rows, Shape::kRows)), dim3(Shape::kThreadCount)},
         reinterpret_cast<const Bf16*>(x.data), reinterpret_cast<const Bf16*>(w.data), static_cast<int>(p.rows),
         static_cast<int>(p.outputs), static_cast<int>(p.depth), ProductEnds{p.bias, p.activation}, p.y);
}

template <class T>
void launch_gather(const DeviceContext& context, DeviceSpan<const float> x, const nn::PatchShape& shape, int64_t first,
                   int64_t depth, bool relu, DeviceSpan<T> out) {
  launch(context, "gather_patches", gather_kernel<T>, one_per_item(out.size, kElementThreads), x, shape, first,
         static_cast<unsigned>(depth), relu, out);
}

}  // namespace

void multiply_bf16(const DeviceContext& context, const ProductSpans& p, DeviceSpan<const uint16_t> x,
                   DeviceSpan<const uint16_t> w) {
  if (p.rows * p.outputs >= kLargeProduct) {
    launch_bf16<4, 2, 2, 4>(context, p, x, w);
  } else {
    launch_bf16<2, 2, 1, 2>(context, p, x, w);
  }
}

void multiply_float(const DeviceContext& context, const ProductSpans& p, DeviceSpan<const float> x,
                    DeviceSpan<const float> w) {
  const auto blocks = [](int64_t n) { return static_cast<unsigned>((n + kFloatTile - 1) / kFloatTile); };
  launch(context, "product_float", product_float_kernel,
         {dim3(blocks(p.outputs), blocks(p.rows)), dim3(kElementThreads)}, x, w, static_cast<int>(p.rows),
         static_cast<int>(p.outputs), static_cast<int>(p.depth), ProductEnds{p.bias, p.activation}, p.y);
}

void round_rows(const DeviceContext& context, DeviceSpan<const float> x, int64_t inputs, bool relu,
                DeviceSpan<uint16_t> out) {
  launch(context, "round_rows", copy_rows_kernel<uint16_t>, one_per_item(out.size, kElementThreads), x,
         static_cast<unsigned>(inputs), static_cast<unsigned>(padded_depth(inputs)), relu, out);
}

void relu_rows(const DeviceContext& context, DeviceSpan<const float> x, DeviceSpan<float> out) {
  launch(context, "relu_rows", copy_rows_kernel<float>, one_per_item(out.size, kElementThreads), x, 1u, 1u, true, out);
}

void gather_patches(const DeviceContext& context, DeviceSpan<const float> x, const nn::PatchShape& shape, int64_t first,
                    bool relu, DeviceSpan<uint16_t> out) {
  launch_gather(context, x, shape, first, padded_depth(shape.kernel * shape.kernel * shape.channels), relu, out);
}
void gather_patches(const DeviceContext& context, DeviceSpan<const float> x, const nn::PatchShape& shape, int64_t first,
                    bool relu, DeviceSpan<float> out) {
  launch_gather(context, x, shape, first, shape.kernel * shape.kernel * shape.channels, relu, out);
}

}  // namespace aligngs::cuda
