#include "nn/vggt_heads.h"

#include <algorithm>
#include <cmath>

#include "nn/ops/blocks.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

constexpr float kVggtHeadNormEps = 1e-5f;  // of the LayerNorms with weights
constexpr float kModulatedEps = 1e-6f;     // of the one without
constexpr int kIterations = 4;

}  // namespace

VggtCameraHead::VggtCameraHead(const Compute& compute, const Weights& weights, int64_t heads) {
  constexpr int64_t kPose = 9, kHeadDim = 128;
  channels_ = weights.dimension("token_norm.weight", 0);
  const int64_t c = channels_;
  if (heads <= 0) heads = c / kHeadDim;
  empty_pose_ = weights.load("empty_pose_tokens", {1, 1, kPose});
  token_norm_ = LayerNorm(weights, "token_norm", c, kVggtHeadNormEps);
  trunk_norm_ = LayerNorm(weights, "trunk_norm", c, kVggtHeadNormEps);
  embed_pose_ = Linear(compute, weights, "embed_pose", c, kPose);
  modulation_ = Linear(compute, weights, "poseLN_modulation.1", 3 * c, c);
  const int64_t hidden = weights.dimension("pose_branch.fc1.weight", 0);
  branch1_ = Linear(compute, weights, "pose_branch.fc1", hidden, c);
  branch2_ = Linear(compute, weights, "pose_branch.fc2", kPose, hidden);
  const int depth = weights.count("trunk.");
  for (int i = 0; i < depth; ++i) {
    trunk_.emplace_back(compute, weights.sub("trunk." + std::to_string(i) + "."),
                        TransformerBlock::Config{c, heads, kVggtHeadNormEps});
  }
}

std::vector<std::vector<PoseEncoding>> VggtCameraHead::operator()(Compute& compute, const Matrix& camera_tokens) const {
  const int64_t frames = camera_tokens.rows, c = channels_;
  const Matrix z = token_norm_(compute, camera_tokens);
  Matrix plain(frames, c);  // z normalised without weights
  layer_norm(z.data.data(), frames, c, nullptr, nullptr, kModulatedEps, plain.data.data());
  Matrix pose(frames, int64_t(empty_pose_.size()));
  std::vector<std::vector<PoseEncoding>> iterations;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Matrix given = pose;
    if (iteration == 0) {
      for (int64_t f = 0; f < frames; ++f) std::copy(empty_pose_.begin(), empty_pose_.end(), given.row(f));
    }
    const Matrix modulation = modulation_(compute, embed_pose_(compute, given, Activation::kSilu));
    Matrix y = z;
    for (int64_t f = 0; f < frames; ++f) {
      const float* shift = modulation.row(f);
      for (int64_t i = 0; i < c; ++i)
        y.row(f)[i] += shift[2 * c + i] * (plain.row(f)[i] * (1 + shift[c + i]) + shift[i]);
    }
    for (const TransformerBlock& block : trunk_) block.forward(compute, y, 1);
    const Matrix delta = branch2_(compute, branch1_(compute, trunk_norm_(compute, y), Activation::kGelu));
    // The next iteration is given the pose without the ReLU of its fields of view.
    for (size_t i = 0; i < pose.data.size(); ++i) pose.data[i] += delta.data[i];
    std::vector<PoseEncoding> encodings(static_cast<size_t>(frames));
    for (int64_t f = 0; f < frames; ++f) {
      PoseEncoding& e = encodings[size_t(f)];
      std::copy_n(pose.row(f), e.size(), e.begin());
      e[7] = std::max(e[7], 0.0f);
      e[8] = std::max(e[8], 0.0f);
    }
    iterations.push_back(std::move(encodings));
  }
  return iterations;
}

float dense_value(DenseActivation activation, float v) {
  return activation == DenseActivation::kDepth ? std::exp(v) : std::copysign(std::expm1(std::abs(v)), v);
}
float dense_confidence(float v) { return 1 + std::exp(v); }

VggtDenseHead::VggtDenseHead(const Compute& compute, const Weights& weights, DenseActivation activation)
    : activation_(activation), pyramid_(compute, weights, {true}), fusion_(compute, weights, {"", true}) {
  const int64_t features = pyramid_.features();
  const int64_t half = weights.dimension("scratch.output_conv1.weight", 0);
  const int64_t last = weights.dimension("scratch.output_conv2.0.weight", 0);
  output1_ = Convolution(compute, weights, "scratch.output_conv1", {half, features, 3, 1, 1});
  output2_ = Convolution(compute, weights, "scratch.output_conv2.0", {last, half, 3, 1, 1});
  output3_ =
      Linear(compute, weights, "scratch.output_conv2.2", weights.dimension("scratch.output_conv2.2.weight", 0), last);
}

FeatureMap VggtDenseHead::operator()(Compute& compute, const AggregatedTokens& tokens, int64_t frame) const {
  constexpr int64_t kPatch = 14;
  const double aspect = double(tokens.grid_width) / double(tokens.grid_height);
  std::vector<FeatureMap> levels;
  constexpr size_t kLevels = 4;  // the camera head's layer may follow
  for (size_t j = 0; j < std::min(kLevels, tokens.layers.size()); ++j) {
    const Matrix& layer = tokens.layers[j];
    FeatureMap map(tokens.grid_height, tokens.grid_width, layer.columns);
    copy_block(compute, map.data, {}, layer.data, {(frame * tokens.per_frame() + tokens.special) * layer.columns, 0}, 1,
               map.places() * layer.columns);
    levels.push_back(std::move(map));
  }
  FeatureMap out = fusion_(compute, pyramid_(compute, std::move(levels), aspect));
  out = output1_(compute, out);
  out = resize_bilinear_map(compute, out, tokens.grid_height * kPatch, tokens.grid_width * kPatch, true);
  add_uv_embedding(compute, out, aspect);
  out = output3_(compute, output2_(compute, out, {false, Activation::kRelu}));
  for (int64_t i = 0; i < out.places(); ++i) {
    float* v = out.data.data() + i * out.channels;
    for (int64_t c = 0; c + 1 < out.channels; ++c) v[c] = dense_value(activation_, v[c]);
    v[out.channels - 1] = dense_confidence(v[out.channels - 1]);
  }
  return out;
}

}  // namespace aligngs::nn
