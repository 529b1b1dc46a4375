#include "nn/ops/linear.h"

#include "nn/network_device.h"

namespace aligngs::nn {

Linear::Linear(const Compute& compute, const std::vector<float>& weight, int64_t outputs, int64_t inputs,
               std::vector<float> bias)
    : matrix_(compute.matrices()->pack(weight.data(), outputs, inputs)), bias_(std::move(bias)) {}

Linear::Linear(const Compute& compute, const Weights& weights, const std::string& name, int64_t outputs, int64_t inputs,
               bool exact) {
  Shape shape = {outputs, inputs};
  if (weights.has(name + ".weight") && weights.shape(name + ".weight").size() == 4)
    shape = {outputs, inputs, 1, 1};  // a convolution of one pixel
  const MatrixBackend& backend = exact ? *compute.exact_matrices() : *compute.matrices();
  matrix_ = backend.pack(weights.load(name + ".weight", shape).data(), outputs, inputs);
  if (weights.has(name + ".bias")) bias_ = weights.load(name + ".bias", {outputs});
}

void Linear::rows(const float* x, int64_t rows, float* y, Scratch& scratch, Activation activation) const {
  matrix_->multiply(x, rows, y, scratch);
  add_bias_and_activate(y, rows, outputs(), bias(), activation);
}

Matrix Linear::product_on(NetworkDevice& device, const Matrix& x) const {
  Matrix y(x.rows, outputs());
  device.product(*matrix_, x.data.on(device), x.rows, {}, y.data.write_on(device));
  return y;
}

void Linear::apply(Compute& compute, const Values& x, int64_t row_count, Values& y, Activation activation) const {
  if (NetworkDevice* const device = compute.device()) {
    const ProductEnds ends{bias_.on(*device), activation, false};
    device->product(*matrix_, x.on(*device), row_count, ends, y.write_on(*device));
    return;
  }
  const float* const from = x.data();
  float* const to = y.data();
  compute.for_rows(row_count, 0, [&](int64_t begin, int64_t count, Scratch& scratch) {
    rows(from + begin * inputs(), count, to + begin * outputs(), scratch, activation);
  });
}

Matrix Linear::operator()(Compute& compute, const Matrix& x, Activation activation) const {
  Matrix y(x.rows, outputs());
  apply(compute, x.data, x.rows, y.data, activation);
  return y;
}

FeatureMap Linear::operator()(Compute& compute, const FeatureMap& x, Activation activation) const {
  FeatureMap y(x.height, x.width, outputs());
  apply(compute, x.data, x.places(), y.data, activation);
  return y;
}

}  // namespace aligngs::nn
