// Common parts of the dense heads of VGGT and DINOv2 (Ranftl et al. 2021, DPT).
#pragma once

#include <string>

#include "nn/ops/convolution.h"
#include "nn/ops/linear.h"

namespace aligngs::nn {

/// conv2(relu(conv1(relu(x)))) + skip.
class ResidualUnit {
 public:
  ResidualUnit() = default;
  /// Convolutions `first` and `second` of channels -> channels. rectified_skip: the skip carries
  /// relu(x), as VGGT's in-place ReLU makes it; otherwise x.
  ResidualUnit(const Compute& compute, const Weights& weights, const std::string& first, const std::string& second,
               int64_t channels, bool rectified_skip);
  FeatureMap operator()(Compute& compute, const FeatureMap& x) const;

 private:
  Convolution conv1_, conv2_;
  bool rectified_skip_ = false;
};

/// One of the four levels, finest first. 1x1 projection, change of resolution (x4, x2, none, 1/2),
/// 3x3 convolution without bias to the width of the fusion.
class DptLevel {
 public:
  struct Names {
    std::string project, resize, features;
  };
  DptLevel(const Compute& compute, const Weights& weights, int level, const Names& names, int64_t inputs,
           int64_t features);

  FeatureMap project(Compute& compute, const FeatureMap& x) const { return project_(compute, x); }
  FeatureMap resize(Compute& compute, FeatureMap x) const;
  FeatureMap features(Compute& compute, const FeatureMap& x) const { return features_(compute, x); }

 private:
  int level_;
  Linear project_;
  TransposedConvolution grow_;
  Convolution shrink_, features_;
};

/// x += y, or x += max(y, 0); both of one size.
void add_map(FeatureMap& x, const FeatureMap& y, bool rectified = false);

}  // namespace aligngs::nn
