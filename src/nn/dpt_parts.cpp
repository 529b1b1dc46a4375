#include "nn/dpt_parts.h"

#include <algorithm>

#include "core/error.h"
#include "nn/ops/blocks.h"

namespace aligngs::nn {

void add_map(FeatureMap& x, const FeatureMap& y, bool rectified) {
  if (x.height != y.height || x.width != y.width || x.channels != y.channels)
    throw Error({ErrorKind::kFailed, "maps of different sizes cannot be added", {}, "size", ""});
  add_values(x.data, y.data, rectified);
}

ResidualUnit::ResidualUnit(const Compute& compute, const Weights& weights, const std::string& first,
                           const std::string& second, int64_t channels, bool rectified_skip)
    : conv1_(compute, weights, first, {channels, channels, 3, 1, 1}),
      conv2_(compute, weights, second, {channels, channels, 3, 1, 1}),
      rectified_skip_(rectified_skip) {}

FeatureMap ResidualUnit::operator()(Compute& compute, const FeatureMap& x) const {
  FeatureMap y = conv2_(compute, conv1_(compute, x, {true, Activation::kRelu}));
  add_map(y, x, rectified_skip_);
  return y;
}

DptLevel::DptLevel(const Compute& compute, const Weights& weights, int level, const Names& names, int64_t inputs,
                   int64_t features)
    : level_(level) {
  const int64_t channels = weights.dimension(names.project + ".weight", 0);
  project_ = Linear(compute, weights, names.project, channels, inputs);
  if (level == 0) grow_ = TransposedConvolution(compute, weights, names.resize, channels, channels, 4);
  if (level == 1) grow_ = TransposedConvolution(compute, weights, names.resize, channels, channels, 2);
  if (level == 3) shrink_ = Convolution(compute, weights, names.resize, {channels, channels, 3, 2, 1});
  features_ = Convolution(compute, weights, names.features, {features, channels, 3, 1, 1});
}

FeatureMap DptLevel::resize(Compute& compute, FeatureMap x) const {
  if (level_ < 2) return grow_(compute, x);
  if (level_ == 3) return shrink_(compute, x);
  return x;
}

}  // namespace aligngs::nn
