// Convolutions over maps with their channels innermost.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "nn/cpu/matrix_backend.h"
#include "nn/cpu/row_kernels.h"
#include "nn/ops/norm.h"
#include "nn/tensor.h"
#include "nn/weights.h"

namespace aligngs::nn {

struct ConvolutionShape {
  int64_t outputs = 0, inputs = 0;
  int64_t kernel = 3;  ///< square
  int64_t stride = 1;
  int64_t padding = 0;  ///< zeros on every side
  bool exact = false;   ///< in float32 whatever the precision
};

/// As a product of matrices over gathered patches, a chunk of places at a time.
class Convolution {
 public:
  Convolution() = default;
  /// weight [outputs, inputs, kernel, kernel]; bias [outputs] or empty.
  Convolution(const Compute& compute, const ConvolutionShape& shape, const std::vector<float>& weight,
              std::vector<float> bias);
  /// `name`.weight and, when there is one, `name`.bias; `norm` (may be null) is folded in.
  Convolution(const Compute& compute, const Weights& weights, const std::string& name, const ConvolutionShape& shape,
              const BatchNorm* norm = nullptr);

  struct Options {
    bool relu_input = false;
    Activation activation = Activation::kNone;
  };
  FeatureMap operator()(Compute& compute, const FeatureMap& x, const Options& options) const;
  FeatureMap operator()(Compute& compute, const FeatureMap& x) const { return (*this)(compute, x, Options()); }
  const ConvolutionShape& shape() const { return shape_; }

 private:
  void pack(const Compute& compute, const std::vector<float>& weight);

  ConvolutionShape shape_;
  std::shared_ptr<const PackedMatrix> matrix_;
  Values bias_;
};

/// Transposed convolution whose stride is its kernel: a product, then a shuffle.
class TransposedConvolution {
 public:
  TransposedConvolution() = default;
  /// weight [inputs, outputs, kernel, kernel]; bias [outputs] or empty.
  TransposedConvolution(const Compute& compute, int64_t outputs, int64_t inputs, int64_t kernel,
                        const std::vector<float>& weight, std::vector<float> bias);
  TransposedConvolution(const Compute& compute, const Weights& weights, const std::string& name, int64_t outputs,
                        int64_t inputs, int64_t kernel);
  FeatureMap operator()(Compute& compute, const FeatureMap& x) const;

 private:
  int64_t outputs_ = 0, kernel_ = 1;
  std::shared_ptr<const PackedMatrix> matrix_;
  Values bias_;
};

/// Each channel with its own 3x3 kernel, stride 1, zeros of one pixel around.
class DepthwiseConvolution {
 public:
  DepthwiseConvolution() = default;
  /// weight [channels, 1, 3, 3].
  DepthwiseConvolution(const std::vector<float>& weight, std::vector<float> bias);
  DepthwiseConvolution(const Weights& weights, const std::string& name, int64_t channels);
  /// x and y hold height * width rows of channels.
  void apply(Compute& compute, const float* x, int64_t height, int64_t width, float* y) const;
  /// The same where x and y are memory of the device.
  void apply_on(NetworkDevice& device, const float* x, int64_t height, int64_t width, float* y) const;

 private:
  Values weight_, bias_;  ///< weight [3][3][channels]
};

/// 3x3, stride 2, padding 1 that never wins.
FeatureMap max_pool_3x3_stride_2(Compute& compute, const FeatureMap& x);
/// 2x2, stride 2; an odd last row or column is left out.
FeatureMap max_pool_2x2(Compute& compute, const FeatureMap& x);

}  // namespace aligngs::nn
