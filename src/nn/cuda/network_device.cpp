#include "nn/cuda/network_device.h"

#include <algorithm>

#include "core/error.h"
#include "core/half.h"
#include "nn/cuda/attention_kernels.h"
#include "nn/cuda/device_pool.h"
#include "nn/cuda/lt_products.h"
#include "nn/cuda/map_operators.h"
#include "nn/cuda/matrix_products.h"
#include "nn/cuda/row_operators.h"

namespace aligngs {
namespace cuda {
namespace {

using nn::Precision;

constexpr uint64_t kMostPatchBytes = 256u << 20;  // gathered patches of a convolution, a part of the places at a time

template <class T>
DeviceSpan<T> span(const std::shared_ptr<T>& memory, int64_t count) {
  return {memory.get(), size_t(count)};
}
DeviceSpan<const float> floats(const float* data, int64_t count) { return {data, size_t(count)}; }
DeviceSpan<float> floats(float* data, int64_t count) { return {data, size_t(count)}; }

class CudaNetworkDevice;

/// Weights on the device: float32, or bfloat16 in rows of padded_depth(inputs).
class CudaMatrix : public nn::PackedMatrix {
 public:
  CudaMatrix(std::shared_ptr<CudaNetworkDevice> device, std::shared_ptr<DevicePool> pool, const float* weights,
             int64_t outputs, int64_t inputs, Precision precision)
      : PackedMatrix(outputs, inputs, precision), device_(std::move(device)), pool_(std::move(pool)) {
    const DeviceContext& context = pool_->context();
    if (precision == Precision::kFloat32) {
      count_ = outputs * inputs;
      memory_ = pool_->take(uint64_t(bytes()), "weights");
      upload(context, {static_cast<float*>(memory_.get()), size_t(count_)}, weights);
      return;
    }
    const int64_t depth = padded_depth(inputs);
    count_ = outputs * depth;
    std::vector<uint16_t> rounded(size_t(count_), uint16_t(0));
    for (int64_t o = 0; o < outputs; ++o) {
      for (int64_t i = 0; i < inputs; ++i) rounded[size_t(o * depth + i)] = float_to_bfloat16(weights[o * inputs + i]);
    }
    memory_ = pool_->take(uint64_t(bytes()), "weights");
    upload(context, {static_cast<uint16_t*>(memory_.get()), size_t(count_)}, rounded.data());
  }

  size_t bytes() const override { return size_t(count_) * (precision() == Precision::kFloat32 ? 4 : 2); }
  void multiply_packed(const void* x, int64_t rows, float* y, nn::Scratch& scratch) const override;

  DeviceSpan<const float> as_floats() const { return {static_cast<const float*>(memory_.get()), size_t(count_)}; }
  DeviceSpan<const uint16_t> as_halves() const { return {static_cast<const uint16_t*>(memory_.get()), size_t(count_)}; }

 private:
  std::shared_ptr<CudaNetworkDevice> device_;
  std::shared_ptr<DevicePool> pool_;
  std::shared_ptr<void> memory_;
  int64_t count_ = 0;
};

class CudaNetworkDevice : public nn::NetworkDevice, public std::enable_shared_from_this<CudaNetworkDevice> {
 public:
  CudaNetworkDevice(int device, uint64_t budget_bytes)
      : pool_(std::make_shared<DevicePool>(device, budget_bytes)),
        products_(context(), start_lt_products(*pool_)),
        name_(context().facts().name) {}

  std::string name() const override { return name_; }
  std::shared_ptr<float> allocate(size_t count) override {
    // A tensor may be looked at when nothing else holds the device any more.
    auto piece = pool_->take<float>(count, "a tensor");
    float* const memory = piece.get();
    return {memory, [piece = std::move(piece), device = shared_from_this()](float*) mutable { piece.reset(); }};
  }
  void upload(float* to, const float* host, size_t count) override {
    context().copy_to_device(to, host, count * sizeof(float));
  }
  void download(float* host, const float* from, size_t count) override {
    context().copy_to_host(host, from, count * sizeof(float));
  }
  void copy(float* to, const float* from, size_t count) override {
    context().copy_on_device(to, from, count * sizeof(float));
  }
  void clear(float* to, size_t count) override { context().fill_bytes(to, 0, count * sizeof(float)); }
  void copy_columns(float* to, int64_t to_stride, const float* from, int64_t from_stride, int64_t rows, int64_t columns,
                    bool add) override {
    const auto reach = [&](int64_t stride) { return (rows - 1) * stride + columns; };
    copy_block(context(), {floats(from, reach(from_stride)), floats(to, reach(to_stride)), from_stride, to_stride, rows,
                           columns, add});
  }

  std::unique_ptr<nn::PackedMatrix> pack(const float* weights, int64_t outputs, int64_t inputs,
                                         Precision precision) override {
    return std::make_unique<CudaMatrix>(shared_from_this(), pool_, weights, outputs, inputs, precision);
  }

  void product(const nn::PackedMatrix& matrix, const float* x, int64_t rows, const nn::ProductEnds& ends,
               float* y) override {
    if (rows == 0) return;
    const int64_t inputs = matrix.inputs();
    if (matrix.precision() == Precision::kBfloat16) {
      const auto operands = pool_->take<uint16_t>(size_t(rows * padded_depth(inputs)), "operands of a product");
      const DeviceSpan<uint16_t> rounded = span(operands, rows * padded_depth(inputs));
      round_rows(context(), floats(x, rows * inputs), inputs, ends.relu_input, rounded);
      multiply(matrix, DeviceSpan<const uint16_t>(rounded), rows, ends, y);
    } else if (ends.relu_input) {
      const auto operands = allocate(size_t(rows * inputs));
      relu_rows(context(), floats(x, rows * inputs), span(operands, rows * inputs));
      multiply(matrix, DeviceSpan<const float>(span(operands, rows * inputs)), rows, ends, y);
    } else {
      multiply(matrix, floats(x, rows * inputs), rows, ends, y);
    }
  }

  void convolution(const nn::PackedMatrix& matrix, const float* x, const nn::PatchShape& shape,
                   const nn::ProductEnds& ends, float* y) override {
    if (shape.kernel == 1 && shape.stride == 1 && shape.padding == 0) {
      product(matrix, x, shape.height * shape.width, ends, y);
    } else if (matrix.precision() == Precision::kBfloat16) {
      convolve<uint16_t>(matrix, x, shape, ends, y, padded_depth(matrix.inputs()));
    } else {
      convolve<float>(matrix, x, shape, ends, y, matrix.inputs());
    }
  }

  void spread_patches(const float* products, int64_t height, int64_t width, int64_t channels, int64_t kernel,
                      const float* bias, float* y) override {
    const int64_t count = height * width * kernel * kernel * channels;
    spread_products(context(), {floats(products, count), floats(y, count), height, width, channels}, kernel, bias);
  }
  void depthwise(const float* x, int64_t height, int64_t width, int64_t channels, const float* weight,
                 const float* bias, float* y) override {
    const int64_t count = height * width * channels;
    depthwise_3x3(context(), {floats(x, count), floats(y, count), height, width, channels}, weight, bias);
  }
  void max_pool(const float* x, const nn::PatchShape& shape, float* y) override {
    pool_map(
        context(),
        {floats(x, shape.height * shape.width * shape.channels),
         floats(y, shape.out_height() * shape.out_width() * shape.channels), shape.height, shape.width, shape.channels},
        shape);
  }
  void resample(const float* x, int64_t height, int64_t width, int64_t channels, const nn::ResampleAxis& vertical,
                const nn::ResampleAxis& horizontal, float* y) override {
    const AxisOnDevice v = axis(vertical), h = axis(horizontal);
    resample_map(context(),
                 {floats(x, height * width * channels), floats(y, vertical.outputs() * horizontal.outputs() * channels),
                  height, width, channels},
                 v.spans, h.spans);
  }

  void prepare_heads(const nn::HeadPreparation& heads, float* qkv) override {
    HeadSpans spans{heads, {}, floats(qkv, heads.rows * 3 * heads.heads * heads.head_dim)};
    std::shared_ptr<int> places;
    if (heads.places != nullptr) spans.places = put(*heads.places, places);
    prepare_head_rows(context(), spans);
  }

  void attention(const nn::AttentionShape& shape, const nn::AttentionRows& queries, const nn::AttentionRows& keys,
                 const nn::AttentionRows& values, const uint8_t* masked, Precision precision, float* out) override {
    if ((shape.masks > 0) != (masked != nullptr)) {
      throw Error({ErrorKind::kFailed, "a mask is given or missing against the shape", {}, "attention", ""});
    }
    if (shape.head_dim > kMostHeadDim) {
      throw Error({ErrorKind::kWeights,
                   "heads of " + std::to_string(shape.head_dim) + " channels do not run on a CUDA device",
                   {},
                   "attention",
                   "use --device cpu"});
    }
    const int64_t width = shape.heads * shape.head_dim;
    const auto rows = [&](const nn::AttentionRows& r, int64_t count) {
      return floats(r.values, (shape.sequences * count - 1) * r.stride + width);
    };
    AttentionSpans spans{shape,
                         rows(queries, shape.queries),
                         rows(keys, shape.keys),
                         rows(values, shape.keys),
                         queries.stride,
                         keys.stride,
                         values.stride,
                         {},
                         floats(out, shape.sequences * shape.queries * width)};
    if (masked == nullptr && precision == Precision::kBfloat16 && shape.head_dim <= kMostTensorHeadDim) {
      attention_bf16(context(), spans);
      return;
    }
    std::shared_ptr<uint8_t> mask;
    if (masked != nullptr) {
      const size_t count = size_t(shape.sequences * shape.masks * shape.queries * shape.keys);
      mask = pool_->take<uint8_t>(count, "a mask of attention");
      cuda::upload(context(), DeviceSpan<uint8_t>{mask.get(), count}, masked);
      spans.masked = {mask.get(), count};
    }
    attention_float(context(), spans);
  }

  void deformable(const nn::DeformableSamples& s, float* out) override {
    DeformableSpans spans{
        s.queries, s.heads, s.head_dim, s.points, int64_t(s.sizes.size()) / 2, s.reference_levels, {}, {},
        {},        {},      {},         {}};
    const int64_t samples = s.queries * s.heads * spans.levels * s.points, width = s.heads * s.head_dim;
    int64_t places = 0;
    std::vector<int> sizes(s.sizes.begin(), s.sizes.end());
    for (size_t l = 0; l + 1 < s.sizes.size(); l += 2) places += s.sizes[l] * s.sizes[l + 1];
    std::shared_ptr<int> kept;
    spans.reference = floats(s.reference, s.queries * s.reference_levels * 2);
    spans.offsets = floats(s.offsets, samples * 2);
    spans.attention = floats(s.attention, samples);
    spans.values = floats(s.values, places * width);
    spans.sizes = put(sizes, kept);
    spans.out = floats(out, s.queries * width);
    deformable_samples(context(), spans);
  }

  void layer_norm(const float* x, int64_t rows, int64_t columns, const float* weight, const float* bias, float eps,
                  float* y) override {
    normalise_rows(context(), rows_of(x, y, rows, columns), weight, bias, eps);
  }
  void group_norm(float* x, int64_t rows, int64_t columns, int64_t groups, const float* weight, const float* bias,
                  double eps, bool relu) override {
    const auto scale = allocate(size_t(columns)), shift = allocate(size_t(columns));
    const RowSpans spans = rows_of(x, x, rows, columns);
    group_statistics(context(), spans, {groups, weight, bias, eps, span(scale, columns), span(shift, columns)});
    scale_and_shift(context(), spans, scale.get(), shift.get(), relu);
  }
  void softmax_rows(float* x, int64_t rows, int64_t columns) override {
    softmax(context(), rows_of(x, x, rows, columns));
  }
  void add_bias_and_activate(float* y, int64_t rows, int64_t columns, const float* bias,
                             nn::Activation activation) override {
    activate(context(), rows_of(y, y, rows, columns), bias, activation);
  }
  void swiglu(const float* x, int64_t rows, int64_t columns, float* out) override {
    gated_silu(context(), {floats(x, 2 * rows * columns), floats(out, rows * columns), rows, columns});
  }
  void add_scaled(float* x, const float* y, int64_t rows, int64_t columns, const float* bias,
                  const float* scale) override {
    accumulate(context(), rows_of(y, x, rows, columns), bias, scale, false);
  }
  void scale_columns(float* x, int64_t rows, int64_t columns, const float* scale, const float* shift) override {
    scale_and_shift(context(), rows_of(x, x, rows, columns), scale, shift, false);
  }
  void add(float* x, const float* y, size_t count, bool rectified) override {
    accumulate(context(), rows_of(y, x, 1, int64_t(count)), nullptr, nullptr, rectified);
  }

  /// Rows of the host through the device.
  void multiply_host(const CudaMatrix& matrix, const void* x, int64_t rows, float* y) {
    const int64_t inputs = matrix.inputs();
    const auto result = allocate(size_t(rows * matrix.outputs()));
    if (matrix.precision() == Precision::kFloat32) {
      const auto operands = allocate(size_t(rows * inputs));
      upload(operands.get(), static_cast<const float*>(x), size_t(rows * inputs));
      multiply(matrix, DeviceSpan<const float>(span(operands, rows * inputs)), rows, {}, result.get());
    } else {
      const int64_t depth = padded_depth(inputs);
      std::vector<uint16_t> padded(size_t(rows * depth), uint16_t(0));
      for (int64_t r = 0; r < rows; ++r) {
        std::copy_n(static_cast<const uint16_t*>(x) + r * inputs, inputs, padded.begin() + std::ptrdiff_t(r * depth));
      }
      const auto operands = pool_->take<uint16_t>(padded.size(), "operands of a product");
      cuda::upload(context(), span(operands, rows * depth), padded.data());
      multiply(matrix, DeviceSpan<const uint16_t>(span(operands, rows * depth)), rows, {}, result.get());
    }
    download(y, result.get(), size_t(rows * matrix.outputs()));
  }

 private:
  struct AxisOnDevice {
    AxisSpans spans;
    std::shared_ptr<int> first, index;
    std::shared_ptr<float> weight;
  };

  DeviceContext& context() { return pool_->context(); }

  static RowSpans rows_of(const float* x, float* y, int64_t rows, int64_t columns) {
    return {floats(x, rows * columns), floats(y, rows * columns), rows, columns};
  }
  DeviceSpan<const int> put(const std::vector<int>& values, std::shared_ptr<int>& owner) {
    owner = pool_->take<int>(values.size(), "indices");
    cuda::upload(context(), span(owner, int64_t(values.size())), values.data());
    return span(owner, int64_t(values.size()));
  }
  AxisOnDevice axis(const nn::ResampleAxis& a) {
    AxisOnDevice out;
    out.spans.first = put(std::vector<int>(a.first.begin(), a.first.end()), out.first);
    out.spans.index = put(std::vector<int>(a.index.begin(), a.index.end()), out.index);
    out.weight = allocate(a.weight.size());
    upload(out.weight.get(), a.weight.data(), a.weight.size());
    out.spans.weight = floats(out.weight.get(), int64_t(a.weight.size()));
    return out;
  }

  ProductSpans product_of(const nn::PackedMatrix& matrix, int64_t rows, const nn::ProductEnds& ends, float* y) const {
    const int64_t depth = matrix.precision() == Precision::kBfloat16 ? padded_depth(matrix.inputs()) : matrix.inputs();
    return {rows, matrix.outputs(), depth, ends.bias, ends.activation, floats(y, rows * matrix.outputs())};
  }
  void multiply(const nn::PackedMatrix& matrix, DeviceSpan<const uint16_t> x, int64_t rows, const nn::ProductEnds& ends,
                float* y) {
    products_.multiply(product_of(matrix, rows, ends, y), x, static_cast<const CudaMatrix&>(matrix).as_halves());
  }
  void multiply(const nn::PackedMatrix& matrix, DeviceSpan<const float> x, int64_t rows, const nn::ProductEnds& ends,
                float* y) {
    products_.multiply(product_of(matrix, rows, ends, y), x, static_cast<const CudaMatrix&>(matrix).as_floats());
  }

  template <class T>
  void convolve(const nn::PackedMatrix& matrix, const float* x, const nn::PatchShape& shape,
                const nn::ProductEnds& ends, float* y, int64_t depth) {
    const int64_t places = shape.out_height() * shape.out_width();
    const int64_t fitting = std::max<int64_t>(int64_t(kMostPatchBytes / sizeof(T)) / depth, 1);
    const int64_t part = std::min(places, fitting);
    const auto patches = pool_->take<T>(size_t(part * depth), "patches of a convolution");
    for (int64_t first = 0; first < places; first += part) {
      const int64_t count = std::min(part, places - first);
      const DeviceSpan<T> gathered = span(patches, count * depth);
      gather_patches(context(), floats(x, shape.height * shape.width * shape.channels), shape, first, ends.relu_input,
                     gathered);
      multiply(matrix, DeviceSpan<const T>(gathered), count, ends, y + first * matrix.outputs());
    }
  }

  std::shared_ptr<DevicePool> pool_;
  MatrixProducts products_;
  std::string name_;
};

void CudaMatrix::multiply_packed(const void* x, int64_t rows, float* y, nn::Scratch&) const {
  device_->multiply_host(*this, x, rows, y);
}

}  // namespace
}  // namespace cuda

std::shared_ptr<nn::NetworkDevice> make_cuda_network_device(int device, uint64_t budget_bytes) {
  return std::make_shared<cuda::CudaNetworkDevice>(device, budget_bytes);
}

}  // namespace aligngs
