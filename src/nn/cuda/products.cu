// Kernels of products.h: products on tensor cores and in float32, and what lays their operands out.
#include "nn/cuda/products.h"

#include "device/constants.h"
#include "device/launch.h"
#include "device/tile_mma.cuh"
#include "nn/cuda/activations.cuh"

namespace aligngs::cuda {

inline constexpr int kProductStep = static_cast<int>(kDepthStep);
/// an odd multiple of 8: rows of a tile fall into different banks
inline constexpr int kOperandStride = kProductStep + 8;
inline constexpr int kOperandChunk = 8;  ///< bfloat16 per 16-byte load
inline constexpr int kChunksPerRow = kProductStep / kOperandChunk;

struct BiasAndActivation {
  const float* bias;
  nn::Activation activation;
};

__device__ __forceinline__ float finished_product(float sum, const BiasAndActivation& ends, int column) {
  return activated(ends.bias == nullptr ? sum : sum + ends.bias[column], ends.activation);
}

/// A block forms kWarpsM * kTilesM x kWarpsN * kTilesN tiles of 16 x 16. The next step's operands are loaded to
/// registers while the tensor cores work on the current ones.
template <int kWarpsM, int kWarpsN, int kTilesM, int kTilesN>
struct ProductBlock {
  static constexpr int kThreadCount = 32 * kWarpsM * kWarpsN;
  static constexpr int kRows = 16 * kWarpsM * kTilesM, kColumns = 16 * kWarpsN * kTilesN;
  static constexpr int kLoadsX = kRows * kChunksPerRow / kThreadCount,
                       kLoadsW = kColumns * kChunksPerRow / kThreadCount;
  static_assert(kLoadsX * kThreadCount == kRows * kChunksPerRow && kLoadsW * kThreadCount == kColumns * kChunksPerRow);
};

template <int kLoads, int kThreadCount>
__device__ __forceinline__ void load_operands(const Bf16* from, int first, int count, int depth, int step, uint4* out) {
#pragma unroll
  for (int l = 0; l < kLoads; ++l) {
    const int chunk = static_cast<int>(threadIdx.x) + l * kThreadCount;
    const int row = first + chunk / kChunksPerRow;
    out[l] = make_uint4(0, 0, 0, 0);
    if (row < count) {
      out[l] = *reinterpret_cast<const uint4*>(from + size_t(row) * size_t(depth) + step * kProductStep +
                                               chunk % kChunksPerRow * kOperandChunk);
    }
  }
}

template <int kLoads, int kThreadCount>
__device__ __forceinline__ void store_operands(const uint4* from, Bf16* shared) {
#pragma unroll
  for (int l = 0; l < kLoads; ++l) {
    const int chunk = static_cast<int>(threadIdx.x) + l * kThreadCount;
    *reinterpret_cast<uint4*>(shared + chunk / kChunksPerRow * kOperandStride + chunk % kChunksPerRow * kOperandChunk) =
        from[l];
  }
}

template <int kWarpsM, int kWarpsN, int kTilesM, int kTilesN>
__global__ void __launch_bounds__(32 * kWarpsM * kWarpsN)
    product_bf16_kernel(const Bf16* x, const Bf16* w, int rows, int outputs, int depth, BiasAndActivation ends,
                        DeviceSpan<float> y) {
  using Shape = ProductBlock<kWarpsM, kWarpsN, kTilesM, kTilesN>;
  constexpr int kSharedX = Shape::kRows * kOperandStride, kSharedW = Shape::kColumns * kOperandStride;
  __shared__ uint4 x_chunks[2 * kSharedX / kOperandChunk], w_chunks[2 * kSharedW / kOperandChunk];
  Bf16* const xs = reinterpret_cast<Bf16*>(x_chunks);
  Bf16* const ws = reinterpret_cast<Bf16*>(w_chunks);
  const int first_row = static_cast<int>(blockIdx.y) * Shape::kRows;
  const int first_column = static_cast<int>(blockIdx.x) * Shape::kColumns;
  const int warp = static_cast<int>(warp_index());
  const int warp_row = warp / kWarpsN * kTilesM * 16, warp_column = warp % kWarpsN * kTilesN * 16;
  TileSum sums[kTilesM][kTilesN];
#pragma unroll
  for (int m = 0; m < kTilesM; ++m) {
#pragma unroll
    for (int n = 0; n < kTilesN; ++n) sums[m][n].clear();
  }
  uint4 next_x[Shape::kLoadsX], next_w[Shape::kLoadsW];
  const int steps = depth / kProductStep;
  const auto load = [&](int step) {
    load_operands<Shape::kLoadsX, Shape::kThreadCount>(x, first_row, rows, depth, step, next_x);
    load_operands<Shape::kLoadsW, Shape::kThreadCount>(w, first_column, outputs, depth, step, next_w);
  };
  const auto store = [&](int buffer) {
    store_operands<Shape::kLoadsX, Shape::kThreadCount>(next_x, xs + buffer * kSharedX);
    store_operands<Shape::kLoadsW, Shape::kThreadCount>(next_w, ws + buffer * kSharedW);
  };
  load(0);
  store(0);
  __syncthreads();
  for (int step = 0; step < steps; ++step) {
    const int buffer = step & 1;
    if (step + 1 < steps) load(step + 1);
#pragma unroll
    for (int k = 0; k < kProductStep; k += kMmaTile) {
      TileOperand left[kTilesM];
#pragma unroll
      for (int m = 0; m < kTilesM; ++m) {
        left[m] = load_left(xs + buffer * kSharedX + (warp_row + m * 16) * kOperandStride + k, kOperandStride);
      }
#pragma unroll
      for (int n = 0; n < kTilesN; ++n) {
        const TileOperand right =
            load_right_transposed(ws + buffer * kSharedW + (warp_column + n * 16) * kOperandStride + k, kOperandStride);
#pragma unroll
        for (int m = 0; m < kTilesM; ++m) multiply_add(sums[m][n], left[m], right);
      }
    }
    if (step + 1 < steps) store(1 - buffer);  // its readers passed the barrier at the end of the step before
    __syncthreads();
  }
#pragma unroll
  for (int m = 0; m < kTilesM; ++m) {
#pragma unroll
    for (int n = 0; n < kTilesN; ++n) {
#pragma unroll
      for (int i = 0; i < 8; ++i) {
        const int row = first_row + warp_row + m * 16 + TileSum::row_of(i);
        const int column = first_column + warp_column + n * 16 + TileSum::column_of(i);
        if (row < rows && column < outputs) {
          y[size_t(row) * size_t(outputs) + size_t(column)] = finished_product(sums[m][n].value[i], ends, column);
        }
      }
    }
  }
}

static_assert(kFloatTile / kFloatPerThread * (kFloatTile / kFloatPerThread) == kElementThreads, "a patch per thread");
inline constexpr int kFloatStride = kFloatTile + 4;  // a multiple of four, so that rows keep the alignment of float4

/// 64 x 64 outputs per block, 4 x 4 per thread.
__global__ void __launch_bounds__(kElementThreads)
    product_float_kernel(DeviceSpan<const float> x, DeviceSpan<const float> w, int rows, int outputs, int depth,
                         BiasAndActivation ends, DeviceSpan<float> y) {
  __shared__ float xs[kFloatStep * kFloatStride], ws[kFloatStep * kFloatStride];
  const int first_row = static_cast<int>(blockIdx.y) * kFloatTile,
            first_column = static_cast<int>(blockIdx.x) * kFloatTile;
  const int t = static_cast<int>(threadIdx.x);
  const int own_row = t / 16 * kFloatPerThread, own_column = t % 16 * kFloatPerThread;
  float sums[kFloatPerThread][kFloatPerThread] = {};
  for (int begin = 0; begin < depth; begin += kFloatStep) {
#pragma unroll
    for (int e = t; e < kFloatTile * kFloatStep; e += static_cast<int>(kElementThreads)) {
      const int row = e / kFloatStep, k = e % kFloatStep;
      const bool inside = begin + k < depth;
      xs[k * kFloatStride + row] =
          inside && first_row + row < rows ? x[size_t(first_row + row) * size_t(depth) + size_t(begin + k)] : 0.0f;
      ws[k * kFloatStride + row] = inside && first_column + row < outputs
                                       ? w[size_t(first_column + row) * size_t(depth) + size_t(begin + k)]
                                       : 0.0f;
    }
    __syncthreads();
#pragma unroll
    for (int k = 0; k < kFloatStep; ++k) {
#pragma unroll
      for (int i = 0; i < kFloatPerThread; ++i) {
#pragma unroll
        for (int j = 0; j < kFloatPerThread; ++j) {
          sums[i][j] += xs[k * kFloatStride + own_row + i] * ws[k * kFloatStride + own_column + j];
        }
      }
    }
    __syncthreads();
  }
#pragma unroll
  for (int i = 0; i < kFloatPerThread; ++i) {
#pragma unroll
    for (int j = 0; j < kFloatPerThread; ++j) {
      const int row = first_row + own_row + i, column = first_column + own_column + j;
      if (row < rows && column < outputs)
        y[size_t(row) * size_t(outputs) + size_t(column)] = finished_product(sums[i][j], ends, column);
    }
  }
}

__device__ __forceinline__ void store_operand(uint16_t& to, float value) {
  const Bf16 rounded = to_bf16(value);
  to = *reinterpret_cast<const uint16_t*>(&rounded);
}
__device__ __forceinline__ void store_operand(float& to, float value) { to = value; }

__device__ __forceinline__ float rectified(float value, bool relu) { return relu && !(value > 0.0f) ? 0.0f : value; }

template <class T>
__global__ void copy_rows_kernel(DeviceSpan<const float> x, unsigned inputs, unsigned depth, bool relu,
                                 DeviceSpan<T> out) {
  const size_t i = item_index();
  if (i >= out.size) return;
  const size_t row = i / depth;
  const auto k = static_cast<unsigned>(i - row * depth);
  store_operand(out[i], k < inputs ? rectified(x[row * inputs + k], relu) : 0.0f);
}

template <class T>
__global__ void gather_kernel(DeviceSpan<const float> x, nn::PatchShape shape, int64_t first, unsigned depth, bool relu,
                              DeviceSpan<T> out) {
  const size_t i = item_index();
  if (i >= out.size) return;
  const size_t patch = i / depth;
  const auto k = static_cast<unsigned>(i - patch * depth), channels = static_cast<unsigned>(shape.channels);
  const auto kernel = static_cast<unsigned>(shape.kernel), tap = k / channels;
  float value = 0.0f;
  if (tap < kernel * kernel) {
    const int64_t place = first + int64_t(patch), width = shape.out_width();
    const int64_t v = place / width * shape.stride - shape.padding + int64_t(tap / kernel);
    const int64_t u = place % width * shape.stride - shape.padding + int64_t(tap % kernel);
    if (v >= 0 && u >= 0 && v < shape.height && u < shape.width) {
      value = rectified(x[size_t(v * shape.width + u) * channels + k % channels], relu);
    }
  }
  store_operand(out[i], value);
}
namespace {

template <int kWarpsM, int kWarpsN, int kTilesM, int kTilesN>
void launch_bf16(const DeviceContext& context, const ProductSpans& p, DeviceSpan<const uint16_t> x,
                 DeviceSpan<const uint16_t> w) {
  using Shape = ProductBlock<kWarpsM, kWarpsN, kTilesM, kTilesN>;
  const auto blocks = [](int64_t n, int64_t size) { return static_cast<unsigned>((n + size - 1) / size); };
  launch(context, "product_bf16", product_bf16_kernel<kWarpsM, kWarpsN, kTilesM, kTilesN>,
         {dim3(blocks(p.outputs, Shape::kColumns), blocks(p.rows, Shape::kRows)), dim3(Shape::kThreadCount)},
         reinterpret_cast<const Bf16*>(x.data), reinterpret_cast<const Bf16*>(w.data), static_cast<int>(p.rows),
         static_cast<int>(p.outputs), static_cast<int>(p.depth), BiasAndActivation{p.bias, p.activation}, p.y);
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
         static_cast<int>(p.outputs), static_cast<int>(p.depth), BiasAndActivation{p.bias, p.activation}, p.y);
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
