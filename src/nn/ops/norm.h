// Normalisations with their weights.
#pragma once

#include <string>
#include <vector>

#include "nn/compute.h"
#include "nn/tensor.h"
#include "nn/weights.h"

namespace aligngs::nn {

class LayerNorm {
 public:
  LayerNorm() = default;
  LayerNorm(const Weights& weights, const std::string& name, int64_t channels, float eps);

  int64_t channels() const { return int64_t(weight_.size()); }
  /// On the calling thread; y may be x.
  void rows(const float* x, int64_t rows, float* y) const;
  Matrix operator()(Compute& compute, const Matrix& x) const;
  const Values& weight() const { return weight_; }
  const Values& bias() const { return bias_; }
  float eps() const { return eps_; }

 private:
  Values weight_, bias_;
  float eps_ = 0;
};

/// Over the channels of each group and all places of the map; eps 1e-5.
class GroupNorm {
 public:
  GroupNorm() = default;
  GroupNorm(const Weights& weights, const std::string& name, int64_t channels, int64_t groups);
  GroupNorm(std::vector<float> weight, std::vector<float> bias, int64_t groups);
  void apply(Compute& compute, FeatureMap& x, bool relu = false) const;

 private:
  Values weight_, bias_;
  int64_t groups_ = 1;
};

/// Inference form: y = scale x + shift per channel; eps 1e-5.
struct BatchNorm {
  Values scale, shift;

  BatchNorm() = default;
  /// weight, bias, running_mean, running_var below `name`.
  BatchNorm(const Weights& weights, const std::string& name, int64_t channels);
  BatchNorm(const std::vector<float>& weight, const std::vector<float>& bias, const std::vector<float>& mean,
            const std::vector<float>& variance);
  void apply(Compute& compute, FeatureMap& x) const;
};

}  // namespace aligngs::nn
