#include "nn/ops/activate.h"

#include "nn/network_device.h"

namespace aligngs::nn {
namespace {

void activate_rows(Compute& compute, Values& x, int64_t rows, int64_t columns, Activation activation) {
  if (NetworkDevice* const device = compute.device()) {
    device->add_bias_and_activate(x.change_on(*device), rows, columns, nullptr, activation);
    return;
  }
  constexpr int64_t kRowChunk = 256;
  float* const values = x.data();
  compute.for_rows(rows, kRowChunk, [&](int64_t begin, int64_t count, Scratch&) {
    add_bias_and_activate(values + begin * columns, count, columns, nullptr, activation);
  });
}

}  // namespace

void activate(Compute& compute, Matrix& x, Activation activation) {
  activate_rows(compute, x.data, x.rows, x.columns, activation);
}

void activate(Compute& compute, FeatureMap& x, Activation activation) {
  activate_rows(compute, x.data, x.places(), x.channels, activation);
}

}  // namespace aligngs::nn
