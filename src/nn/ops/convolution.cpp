#include "nn/ops/convolution.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "nn/network_device.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kRowChunk = 256;

/// The map in the type that products want, rectified if asked for.
AlignedBytes operands_of(Compute& compute, const FeatureMap& x, bool relu, Precision precision) {
  const bool half = precision == Precision::kBfloat16;
  AlignedBytes out(x.data.size() * (half ? sizeof(uint16_t) : sizeof(float)));
  compute.for_rows(x.places(), kRowChunk, [&](int64_t begin, int64_t count, Scratch&) {
    const int64_t first = begin * x.channels, values = count * x.channels;
    const float* from = x.data.data() + first;
    if (half) {
      round_to_bfloat16(from, values, relu, reinterpret_cast<uint16_t*>(out.get()) + first);
    } else if (relu) {
      relu_copy(from, values, reinterpret_cast<float*>(out.get()) + first);
    } else {
      std::copy_n(from, values, reinterpret_cast<float*>(out.get()) + first);
    }
  });
  return out;
}

}  // namespace

Convolution::Convolution(const Compute& compute, const ConvolutionShape& shape, const std::vector<float>& weight,
                         std::vector<float> bias)
    : shape_(shape), bias_(std::move(bias)) {
  pack(compute, weight);
}

Convolution::Convolution(const Compute& compute, const Weights& weights, const std::string& name,
                         const ConvolutionShape& shape, const BatchNorm* norm)
    : shape_(shape) {
  std::vector<float> weight = weights.load(name + ".weight", {shape.outputs, shape.inputs, shape.kernel, shape.kernel});
  if (weights.has(name + ".bias")) bias_ = weights.load(name + ".bias", {shape.outputs});
  if (norm) {
    if (bias_.empty()) bias_ = Values(static_cast<size_t>(shape.outputs));
    const size_t size = weight.size() / static_cast<size_t>(shape.outputs);
    for (size_t o = 0; o < bias_.size(); ++o) {
      for (size_t i = 0; i < size; ++i) weight[o * size + i] *= norm->scale[o];
      bias_[o] = bias_[o] * norm->scale[o] + norm->shift[o];
    }
  }
  pack(compute, weight);
}

void Convolution::pack(const Compute& compute, const std::vector<float>& weight) {
  // [outputs][inputs][taps] to [outputs][taps][inputs], the order in which patches are gathered.
  const int64_t taps = shape_.kernel * shape_.kernel;
  std::vector<float> ordered(weight.size());
  for (int64_t o = 0; o < shape_.outputs; ++o) {
    for (int64_t i = 0; i < shape_.inputs; ++i) {
      for (int64_t t = 0; t < taps; ++t) {
        ordered[size_t((o * taps + t) * shape_.inputs + i)] = weight[size_t((o * shape_.inputs + i) * taps + t)];
      }
    }
  }
  const MatrixBackend& backend = shape_.exact ? *compute.exact_matrices() : *compute.matrices();
  matrix_ = backend.pack(ordered.data(), shape_.outputs, taps * shape_.inputs);
}

FeatureMap Convolution::operator()(Compute& compute, const FeatureMap& x, const Options& options) const {
  const int64_t k = shape_.kernel, pad = shape_.padding, depth = k * k * shape_.inputs;
  if (x.channels != shape_.inputs || x.height + 2 * pad < k || x.width + 2 * pad < k)
    throw Error({ErrorKind::kFailed, "the map does not fit the convolution", {}, "channels", ""});
  FeatureMap y((x.height + 2 * pad - k) / shape_.stride + 1, (x.width + 2 * pad - k) / shape_.stride + 1,
               shape_.outputs);
  if (NetworkDevice* const device = compute.device()) {
    device->convolution(*matrix_, x.data.on(*device), {x.height, x.width, x.channels, k, shape_.stride, pad},
                        {bias_.on(*device), options.activation, options.relu_input}, y.data.write_on(*device));
    return y;
  }
  const bool as_it_is = matrix_->precision() != Precision::kBfloat16 && !options.relu_input;
  const AlignedBytes made =
      as_it_is ? AlignedBytes() : operands_of(compute, x, options.relu_input, matrix_->precision());
  const char* const operands = as_it_is ? reinterpret_cast<const char*>(x.data.data()) : made.get();
  const size_t item = matrix_->precision() == Precision::kBfloat16 ? 2 : 4;
  const size_t pixel = size_t(x.channels) * item;
  // Patches of a chunk: about a megabyte, so that they stay in the second cache.
  constexpr int64_t kPatchBytes = 1 << 20, kFewest = 128;
  const int64_t fitting = kPatchBytes / (depth * int64_t(item)) / 16 * 16;
  const int64_t chunk = std::clamp(fitting, kFewest, kRowChunk);
  const float* bias = bias_.empty() ? nullptr : bias_.data();
  compute.for_rows(y.places(), chunk, [&](int64_t begin, int64_t count, Scratch& scratch) {
    char* patches = static_cast<char*>(scratch.bytes(size_t(count * depth) * item));
    char* out = patches;
    for (int64_t place = begin; place < begin + count; ++place) {
      const int64_t top = place / y.width * shape_.stride - pad;
      const int64_t left = place % y.width * shape_.stride - pad;
      // The columns of the kernel that lie inside are consecutive in memory.
      const int64_t from = std::max<int64_t>(0, -left), to = std::min(k, x.width - left);
      for (int64_t ky = 0; ky < k; ++ky, out += size_t(k) * pixel) {
        const int64_t row = top + ky;
        if (row < 0 || row >= x.height || from >= to) {
          std::memset(out, 0, size_t(k) * pixel);
          continue;
        }
        std::memset(out, 0, size_t(from) * pixel);
        std::memcpy(out + size_t(from) * pixel, operands + size_t(row * x.width + left + from) * pixel,
                    size_t(to - from) * pixel);
        std::memset(out + size_t(to) * pixel, 0, size_t(k - to) * pixel);
      }
    }
    float* result = y.data.data() + begin * y.channels;
    matrix_->multiply_operands(patches, count, result, scratch);
    add_bias_and_activate(result, count, y.channels, bias, options.activation);
  });
  return y;
}

TransposedConvolution::TransposedConvolution(const Compute& compute, int64_t outputs, int64_t inputs, int64_t kernel,
                                             const std::vector<float>& weight, std::vector<float> bias)
    : outputs_(outputs), kernel_(kernel), bias_(std::move(bias)) {
  const int64_t taps = kernel * kernel;
  std::vector<float> ordered(weight.size());  // [taps][outputs][inputs]
  for (int64_t i = 0; i < inputs; ++i) {
    for (int64_t o = 0; o < outputs; ++o) {
      for (int64_t t = 0; t < taps; ++t) {
        ordered[size_t((t * outputs + o) * inputs + i)] = weight[size_t((i * outputs + o) * taps + t)];
      }
    }
  }
  matrix_ = compute.matrices()->pack(ordered.data(), taps * outputs, inputs);
}

TransposedConvolution::TransposedConvolution(const Compute& compute, const Weights& weights, const std::string& name,
                                             int64_t outputs, int64_t inputs, int64_t kernel)
    : TransposedConvolution(
          compute, outputs, inputs, kernel, weights.load(name + ".weight", {inputs, outputs, kernel, kernel}),
          weights.has(name + ".bias") ? weights.load(name + ".bias", {outputs}) : std::vector<float>()) {}

FeatureMap TransposedConvolution::operator()(Compute& compute, const FeatureMap& x) const {
  FeatureMap y(x.height * kernel_, x.width * kernel_, outputs_);
  if (NetworkDevice* const device = compute.device()) {
    Values products(size_t(x.places() * kernel_ * kernel_ * outputs_));
    float* const made = products.write_on(*device);
    device->product(*matrix_, x.data.on(*device), x.places(), {}, made);
    device->spread_patches(made, x.height, x.width, outputs_, kernel_, bias_.on(*device), y.data.write_on(*device));
    return y;
  }
  compute.for_rows(x.places(), 0, [&](int64_t begin, int64_t count, Scratch& scratch) {
    const int64_t taps = kernel_ * kernel_;
    float* products = scratch.floats(size_t(count * taps * outputs_));
    matrix_->multiply(x.data.data() + begin * x.channels, count, products, scratch);
    for (int64_t i = 0; i < count; ++i) {
      const int64_t row = (begin + i) / x.width, column = (begin + i) % x.width;
      for (int64_t t = 0; t < taps; ++t) {
        const float* from = products + (i * taps + t) * outputs_;
        float* to = y.at(row * kernel_ + t / kernel_, column * kernel_ + t % kernel_);
        for (int64_t o = 0; o < outputs_; ++o) to[o] = from[o] + (bias_.empty() ? 0.0f : bias_[size_t(o)]);
      }
    }
  });
  return y;
}

DepthwiseConvolution::DepthwiseConvolution(const std::vector<float>& weight, std::vector<float> bias)
    : weight_(weight.size()), bias_(std::move(bias)) {
  const size_t channels = bias_.size();
  float* const ordered = weight_.data();
  for (size_t c = 0; c < channels; ++c) {
    for (size_t t = 0; t < 9; ++t) ordered[t * channels + c] = weight[c * 9 + t];
  }
}

DepthwiseConvolution::DepthwiseConvolution(const Weights& weights, const std::string& name, int64_t channels)
    : DepthwiseConvolution(weights.load(name + ".weight", {channels, 1, 3, 3}),
                           weights.load(name + ".bias", {channels})) {}

void DepthwiseConvolution::apply_on(NetworkDevice& device, const float* x, int64_t height, int64_t width,
                                    float* y) const {
  device.depthwise(x, height, width, int64_t(bias_.size()), weight_.on(device), bias_.on(device), y);
}

void DepthwiseConvolution::apply(Compute& compute, const float* x, int64_t height, int64_t width, float* y) const {
  const int64_t channels = int64_t(bias_.size());
  compute.for_rows(height, 1, [&](int64_t row, int64_t, Scratch&) {
    for (int64_t column = 0; column < width; ++column) {
      float* out = y + (row * width + column) * channels;
      std::copy(bias_.begin(), bias_.end(), out);
      for (int64_t t = 0; t < 9; ++t) {
        const int64_t v = row + t / 3 - 1, u = column + t % 3 - 1;
        if (v < 0 || v >= height || u < 0 || u >= width) continue;
        const float* in = x + (v * width + u) * channels;
        const float* w = weight_.data() + t * channels;
        for (int64_t c = 0; c < channels; ++c) out[c] += w[c] * in[c];
      }
    }
  });
}

FeatureMap max_pool_3x3_stride_2(Compute& compute, const FeatureMap& x) {
  FeatureMap y((x.height - 1) / 2 + 1, (x.width - 1) / 2 + 1, x.channels);
  if (NetworkDevice* const device = compute.device()) {
    device->max_pool(x.data.on(*device), {x.height, x.width, x.channels, 3, 2, 1}, y.data.write_on(*device));
    return y;
  }
  compute.for_rows(y.height, 1, [&](int64_t row, int64_t, Scratch&) {
    for (int64_t column = 0; column < y.width; ++column) {
      float* out = y.at(row, column);
      std::fill_n(out, y.channels, -std::numeric_limits<float>::infinity());
      for (int64_t t = 0; t < 9; ++t) {
        const int64_t v = 2 * row + t / 3 - 1, u = 2 * column + t % 3 - 1;
        if (v < 0 || v >= x.height || u < 0 || u >= x.width) continue;
        const float* in = x.at(v, u);
        for (int64_t c = 0; c < y.channels; ++c) out[c] = std::max(out[c], in[c]);
      }
    }
  });
  return y;
}

FeatureMap max_pool_2x2(Compute& compute, const FeatureMap& x) {
  FeatureMap y(x.height / 2, x.width / 2, x.channels);
  if (NetworkDevice* const device = compute.device()) {
    device->max_pool(x.data.on(*device), {x.height, x.width, x.channels, 2, 2, 0}, y.data.write_on(*device));
    return y;
  }
  compute.for_rows(y.height, 1, [&](int64_t row, int64_t, Scratch&) {
    for (int64_t column = 0; column < y.width; ++column) {
      float* out = y.at(row, column);
      for (int64_t c = 0; c < y.channels; ++c) {
        out[c] = std::max(std::max(x.at(2 * row, 2 * column)[c], x.at(2 * row, 2 * column + 1)[c]),
                          std::max(x.at(2 * row + 1, 2 * column)[c], x.at(2 * row + 1, 2 * column + 1)[c]));
      }
    }
  });
  return y;
}

}  // namespace aligngs::nn
