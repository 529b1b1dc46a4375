#include "nn/ops/norm.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "nn/cpu/row_kernels.h"
#include "nn/network_device.h"

namespace aligngs::nn {
namespace {

constexpr double kGroupNormEps = 1e-5;  // of group and batch norm in PyTorch
constexpr int64_t kNormRowChunk = 256;

}  // namespace

LayerNorm::LayerNorm(const Weights& weights, const std::string& name, int64_t channels, float eps)
    : weight_(weights.load(name + ".weight", {channels})), bias_(weights.load(name + ".bias", {channels})), eps_(eps) {}

void LayerNorm::rows(const float* x, int64_t rows, float* y) const {
  layer_norm(x, rows, channels(), weight_.data(), bias_.data(), eps_, y);
}

Matrix LayerNorm::operator()(Compute& compute, const Matrix& x) const {
  Matrix y(x.rows, x.columns);
  if (NetworkDevice* const device = compute.device()) {
    device->layer_norm(x.data.on(*device), x.rows, x.columns, weight_.on(*device), bias_.on(*device), eps_,
                       y.data.write_on(*device));
    return y;
  }
  compute.for_rows(x.rows, kNormRowChunk,
                   [&](int64_t begin, int64_t count, Scratch&) { rows(x.row(begin), count, y.row(begin)); });
  return y;
}

GroupNorm::GroupNorm(std::vector<float> weight, std::vector<float> bias, int64_t groups)
    : weight_(std::move(weight)), bias_(std::move(bias)), groups_(groups) {
  if (groups <= 0 || int64_t(weight_.size()) % groups != 0) {
    throw Error({ErrorKind::kWeights,
                 std::to_string(weight_.size()) + " channels do not divide into " + std::to_string(groups) + " groups",
                 {},
                 "group norm",
                 "set the number of groups"});
  }
}

GroupNorm::GroupNorm(const Weights& weights, const std::string& name, int64_t channels, int64_t groups)
    : GroupNorm(weights.load(name + ".weight", {channels}), weights.load(name + ".bias", {channels}), groups) {}

void GroupNorm::apply(Compute& compute, FeatureMap& x, bool relu) const {
  if (NetworkDevice* const device = compute.device()) {
    device->group_norm(x.data.change_on(*device), x.places(), x.channels, groups_, weight_.on(*device),
                       bias_.on(*device), kGroupNormEps, relu);
    return;
  }
  const int64_t size = x.channels / groups_, places = x.places();
  // Sums per fixed chunk of places, added in order: the same for any number of threads.
  const int64_t chunks = (places + kNormRowChunk - 1) / kNormRowChunk;
  std::vector<double> sums(size_t(chunks * groups_)), squares(sums.size());
  const auto over_chunks = [&](const std::function<void(int64_t, int64_t, int64_t)>& body) {
    compute.for_rows(places, kNormRowChunk,
                     [&](int64_t begin, int64_t count, Scratch&) { body(begin / kNormRowChunk, begin, count); });
  };
  const auto total = [&](const std::vector<double>& parts, int64_t group) {
    double sum = 0;
    for (int64_t c = 0; c < chunks; ++c) sum += parts[size_t(c * groups_ + group)];
    return sum / (double(places) * double(size));
  };
  over_chunks([&](int64_t chunk, int64_t begin, int64_t count) {
    for (int64_t p = begin; p < begin + count; ++p) {
      const float* row = x.data.data() + p * x.channels;
      for (int64_t c = 0; c < x.channels; ++c) sums[size_t(chunk * groups_ + c / size)] += row[c];
    }
  });
  std::vector<double> mean(static_cast<size_t>(groups_));
  for (int64_t g = 0; g < groups_; ++g) mean[size_t(g)] = total(sums, g);
  over_chunks([&](int64_t chunk, int64_t begin, int64_t count) {
    for (int64_t p = begin; p < begin + count; ++p) {
      const float* row = x.data.data() + p * x.channels;
      for (int64_t c = 0; c < x.channels; ++c) {
        const double v = row[c] - mean[size_t(c / size)];
        squares[size_t(chunk * groups_ + c / size)] += v * v;
      }
    }
  });
  std::vector<float> scale(size_t(x.channels)), shift(size_t(x.channels));
  for (int64_t c = 0; c < x.channels; ++c) {
    const int64_t g = c / size;
    const double s = double(weight_[size_t(c)]) / std::sqrt(total(squares, g) + kGroupNormEps);
    scale[size_t(c)] = float(s);
    shift[size_t(c)] = float(double(bias_[size_t(c)]) - mean[size_t(g)] * s);
  }
  over_chunks([&](int64_t, int64_t begin, int64_t count) {
    for (int64_t p = begin; p < begin + count; ++p) {
      float* row = x.data.data() + p * x.channels;
      for (int64_t c = 0; c < x.channels; ++c) {
        const float v = row[c] * scale[size_t(c)] + shift[size_t(c)];
        row[c] = relu ? std::max(v, 0.0f) : v;
      }
    }
  });
}

BatchNorm::BatchNorm(const std::vector<float>& weight, const std::vector<float>& bias, const std::vector<float>& mean,
                     const std::vector<float>& variance)
    : scale(weight.size()), shift(weight.size()) {
  for (size_t c = 0; c < weight.size(); ++c) {
    const double s = double(weight[c]) / std::sqrt(double(variance[c]) + kGroupNormEps);
    scale[c] = float(s);
    shift[c] = float(double(bias[c]) - double(mean[c]) * s);
  }
}

BatchNorm::BatchNorm(const Weights& weights, const std::string& name, int64_t channels)
    : BatchNorm(weights.load(name + ".weight", {channels}), weights.load(name + ".bias", {channels}),
                weights.load(name + ".running_mean", {channels}), weights.load(name + ".running_var", {channels})) {}

void BatchNorm::apply(Compute& compute, FeatureMap& x) const {
  if (NetworkDevice* const device = compute.device()) {
    device->scale_columns(x.data.change_on(*device), x.places(), x.channels, scale.on(*device), shift.on(*device));
    return;
  }
  compute.for_rows(x.places(), kNormRowChunk, [&](int64_t begin, int64_t count, Scratch&) {
    for (int64_t p = begin; p < begin + count; ++p) {
      float* row = x.data.data() + p * x.channels;
      for (int64_t c = 0; c < x.channels; ++c) row[c] = row[c] * scale[size_t(c)] + shift[size_t(c)];
    }
  });
}

}  // namespace aligngs::nn
