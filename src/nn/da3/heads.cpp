#include "nn/da3/heads.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "nn/ops/activate.h"
#include "nn/ops/blocks.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

constexpr float kHeadNormEps = 1e-5f;
constexpr int64_t kRayValues = 7;

/// A 3x3 convolution that keeps the size of the map.
Convolution convolution_of(const Compute& compute, const Weights& weights, const std::string& name, int64_t inputs) {
  return Convolution(compute, weights, name, {weights.dimension(name + ".weight", 0), inputs, 3, 1, 1});
}

}  // namespace

Da3DualHead::Da3DualHead(const Compute& compute, const Weights& weights)
    : pyramid_(compute, weights, {true}),
      fusion_(compute, weights, {"", false}),
      output1_(convolution_of(compute, weights, "scratch.output_conv1", pyramid_.features())),
      output2_(convolution_of(compute, weights, "scratch.output_conv2.0", output1_.shape().outputs)),
      output3_(compute, weights, "scratch.output_conv2.2", 2, output2_.shape().outputs) {
  // Only the finest of the four ray levels is used. All share one LayerNorm, which is stored once, with the first.
  const std::string last = "scratch.output_conv2_aux.3", shared = "scratch.output_conv2_aux.0.2";
  if (!weights.has(last + ".5.weight")) return;
  ray_fusion_.emplace_back(compute, weights, DptFusion::Options{"_aux", false});
  const std::string widths = "scratch.output_conv1_aux.3.";
  int64_t channels = pyramid_.features();
  for (int i = 0; i < weights.count(widths); ++i) {
    ray_widths_.push_back(convolution_of(compute, weights, widths + std::to_string(i), channels));
    channels = ray_widths_.back().shape().outputs;
  }
  if (ray_widths_.empty()) weights.shape(widths + "0.weight");  // throws: missing
  ray_hidden_ = convolution_of(compute, weights, last + ".0", channels);
  ray_norm_ = LayerNorm(weights, weights.has(last + ".2.weight") ? last + ".2" : shared, ray_hidden_.shape().outputs,
                        kHeadNormEps);
  ray_output_ = Linear(compute, weights, last + ".5", kRayValues, ray_hidden_.shape().outputs);
}

FeatureMap Da3DualHead::rays_of(Compute& compute, const std::vector<FeatureMap>& levels, double aspect) const {
  FeatureMap x = ray_fusion_.front()(compute, levels);
  for (const Convolution& convolution : ray_widths_) x = convolution(compute, x);
  add_uv_embedding(compute, x, aspect);
  x = ray_hidden_(compute, x);
  const int64_t height = x.height, width = x.width;
  Matrix rows = ray_norm_(compute, std::move(x).take_rows());
  activate(compute, rows, Activation::kRelu);
  FeatureMap rays = ray_output_(compute, FeatureMap(height, width, std::move(rows)));
  for (int64_t i = 0; i < rays.places(); ++i) {
    float& confidence = rays.data[size_t(i * kRayValues + kRayValues - 1)];
    confidence = 1 + std::exp(confidence);
  }
  return rays;
}

Da3DualHead::Output Da3DualHead::operator()(Compute& compute, std::vector<FeatureMap> maps, int64_t height,
                                            int64_t width, bool rays) const {
  const double aspect = double(width) / double(height);
  const std::vector<FeatureMap> levels = pyramid_(compute, std::move(maps), aspect);
  FeatureMap x = resize_bilinear_map(compute, output1_(compute, fusion_(compute, levels)), height, width, true);
  add_uv_embedding(compute, x, aspect);
  Output out;
  out.depth = output3_(compute, output2_(compute, x, {false, Activation::kRelu}));
  float* const values = out.depth.data.data();
  compute.for_rows(height, 1, [&](int64_t row, int64_t, Scratch&) {
    for (int64_t i = row * width; i < (row + 1) * width; ++i) {
      values[2 * i] = std::exp(values[2 * i]);
      values[2 * i + 1] = 1 + std::exp(values[2 * i + 1]);
    }
  });
  if (rays) out.rays = rays_of(compute, levels, aspect);
  return out;
}

Da3SkyHead::Da3SkyHead(const Compute& compute, const Weights& weights)
    : pyramid_(compute, weights, {false}),
      fusion_(compute, weights, {"", false}),
      output1_(convolution_of(compute, weights, "scratch.output_conv1", pyramid_.features())) {
  const std::string names[] = {"scratch.output_conv2", "scratch.sky_output_conv2"};
  for (size_t i = 0; i < branches_.size(); ++i) {
    branches_[i].hidden = convolution_of(compute, weights, names[i] + ".0", output1_.shape().outputs);
    branches_[i].output = Linear(compute, weights, names[i] + ".2", 1, branches_[i].hidden.shape().outputs);
  }
}

FeatureMap Da3SkyHead::operator()(Compute& compute, std::vector<FeatureMap> maps, int64_t height, int64_t width) const {
  const FeatureMap fused = fusion_(compute, pyramid_(compute, std::move(maps), double(width) / double(height)));
  const FeatureMap x = resize_bilinear_map(compute, output1_(compute, fused), height, width, true);
  FeatureMap out(height, width, 2);
  for (size_t b = 0; b < branches_.size(); ++b) {
    const FeatureMap value = branches_[b].output(compute, branches_[b].hidden(compute, x, {false, Activation::kRelu}));
    const float* const from = value.data.data();
    float* const to = out.data.data() + b;
    for (int64_t i = 0; i < out.places(); ++i) to[2 * i] = b == 0 ? std::exp(from[i]) : std::max(from[i], 0.0f);
  }
  return out;
}

}  // namespace aligngs::nn
