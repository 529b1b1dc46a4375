// y = activation(x W^T + b).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "nn/cpu/matrix_backend.h"
#include "nn/cpu/row_kernels.h"
#include "nn/tensor.h"
#include "nn/weights.h"

namespace aligngs::nn {

class Linear {
 public:
  Linear() = default;
  /// weight [outputs, inputs]; bias [outputs], or empty.
  Linear(const Compute& compute, const std::vector<float>& weight, int64_t outputs, int64_t inputs,
         std::vector<float> bias);
  /// `name`.weight [outputs, inputs] (or [outputs, inputs, 1, 1]) and, when there is one,
  /// `name`.bias.
  /// exact: in float32 whatever the precision.
  Linear(const Compute& compute, const Weights& weights, const std::string& name, int64_t outputs, int64_t inputs,
         bool exact = false);

  bool empty() const { return !matrix_; }
  int64_t inputs() const { return matrix_->inputs(); }
  int64_t outputs() const { return matrix_->outputs(); }
  const float* bias() const { return bias_.empty() ? nullptr : bias_.data(); }

  /// On the calling thread: the product alone, without bias.
  void product(const float* x, int64_t rows, float* y, Scratch& scratch) const {
    matrix_->multiply(x, rows, y, scratch);
  }
  /// On the calling thread.
  void rows(const float* x, int64_t rows, float* y, Scratch& scratch, Activation activation = Activation::kNone) const;
  /// The product alone, on a device.
  Matrix product_on(NetworkDevice& device, const Matrix& x) const;
  const Values& bias_values() const { return bias_; }
  /// On all threads, or on the device.
  Matrix operator()(Compute& compute, const Matrix& x, Activation activation = Activation::kNone) const;
  FeatureMap operator()(Compute& compute, const FeatureMap& x, Activation activation = Activation::kNone) const;

 private:
  void apply(Compute& compute, const Values& x, int64_t rows, Values& y, Activation activation) const;

  std::shared_ptr<const PackedMatrix> matrix_;
  Values bias_;
};

}  // namespace aligngs::nn
