#include "nn/vggt_heads.h"

#include <algorithm>
#include <cmath>

#include "nn/ops/blocks.h"
#include "nn/ops/position_encoding.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

constexpr float kEps = 1e-5f;           // of the LayerNorms with weights
constexpr float kModulatedEps = 1e-6f;  // of the one without
constexpr int kIterations = 4;
constexpr float kEmbeddingRatio = 0.1f;  // of the uv embedding

/// x += 0.1 uv embedding.
void add_uv_embedding(FeatureMap& x, double aspect) {
  FeatureMap uv = uv_embedding(x.height, x.width, x.channels, aspect);
  for (float& v : uv.data) v *= kEmbeddingRatio;
  add_values(x.data, uv.data);
}

}  // namespace

VggtCameraHead::VggtCameraHead(const Compute& compute, const Weights& weights, int64_t heads) {
  constexpr int64_t kPose = 9, kHeadDim = 128;
  channels_ = weights.dimension("token_norm.weight", 0);
  const int64_t c = channels_;
  if (heads <= 0) heads = c / kHeadDim;
  empty_pose_ = weights.load("empty_pose_tokens", {1, 1, kPose});
  token_norm_ = LayerNorm(weights, "token_norm", c, kEps);
  trunk_norm_ = LayerNorm(weights, "trunk_norm", c, kEps);
  embed_pose_ = Linear(compute, weights, "embed_pose", c, kPose);
  modulation_ = Linear(compute, weights, "poseLN_modulation.1", 3 * c, c);
  const int64_t hidden = weights.dimension("pose_branch.fc1.weight", 0);
  branch1_ = Linear(compute, weights, "pose_branch.fc1", hidden, c);
  branch2_ = Linear(compute, weights, "pose_branch.fc2", kPose, hidden);
  const int depth = weights.count("trunk.");
  for (int i = 0; i < depth; ++i) {
    trunk_.emplace_back(compute, weights.sub("trunk." + std::to_string(i) + "."),
                        TransformerBlock::Config{c, heads, kEps});
  }
}

std::vector<std::vector<PoseEncoding>> VggtCameraHead::operator()(
    Compute& compute, const Matrix& camera_tokens) const {
  const int64_t frames = camera_tokens.rows, c = channels_;
  const Matrix z = token_norm_(compute, camera_tokens);
  Matrix plain(frames, c);  // z normalised without weights
  layer_norm(z.data.data(), frames, c, nullptr, nullptr, kModulatedEps, plain.data.data());
  Matrix pose(frames, int64_t(empty_pose_.size()));
  std::vector<std::vector<PoseEncoding>> iterations;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Matrix given = pose;
    if (iteration == 0) {
      for (int64_t f = 0; f < frames; ++f)
        std::copy(empty_pose_.begin(), empty_pose_.end(), given.row(f));
    }
    const Matrix modulation = modulation_(compute, embed_pose_(compute, given, Activation::kSilu));
    Matrix y = z;
    for (int64_t f = 0; f < frames; ++f) {
      const float* shift = modulation.row(f);
      for (int64_t i = 0; i < c; ++i)
        y.row(f)[i] += shift[2 * c + i] * (plain.row(f)[i] * (1 + shift[c + i]) + shift[i]);
    }
    for (const TransformerBlock& block : trunk_) block.forward(compute, y, 1);
    const Matrix delta =
        branch2_(compute, branch1_(compute, trunk_norm_(compute, y), Activation::kGelu));
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
  return activation == DenseActivation::kDepth ? std::exp(v)
                                               : std::copysign(std::expm1(std::abs(v)), v);
}
float dense_confidence(float v) { return 1 + std::exp(v); }

VggtDenseHead::VggtDenseHead(const Compute& compute, const Weights& weights,
                             DenseActivation activation)
    : activation_(activation) {
  const int64_t inputs = weights.dimension("norm.weight", 0);
  norm_ = LayerNorm(weights, "norm", inputs, kEps);
  const int64_t features = weights.dimension("scratch.layer1_rn.weight", 0);
  for (int j = 0; j < 4; ++j) {
    const std::string n = std::to_string(j);
    levels_.emplace_back(compute, weights, j,
                         DptLevel::Names{"projects." + n, "resize_layers." + n,
                                         "scratch.layer" + std::to_string(j + 1) + "_rn"},
                         inputs, features);
    const std::string p = "scratch.refinenet" + std::to_string(j + 1) + ".";
    const auto unit = [&](const std::string& name) {
      return ResidualUnit(compute, weights, p + name + ".conv1", p + name + ".conv2", features,
                          true);
    };
    Fusion fusion;
    if (j < 3) fusion.unit1 = unit("resConfUnit1");
    fusion.unit2 = unit("resConfUnit2");
    fusion.out = Linear(compute, weights, p + "out_conv", features, features);
    fusions_.push_back(std::move(fusion));
  }
  const int64_t half = weights.dimension("scratch.output_conv1.weight", 0);
  const int64_t last = weights.dimension("scratch.output_conv2.0.weight", 0);
  output1_ = Convolution(compute, weights, "scratch.output_conv1", {half, features, 3, 1, 1});
  output2_ = Convolution(compute, weights, "scratch.output_conv2.0", {last, half, 3, 1, 1});
  output3_ = Linear(compute, weights, "scratch.output_conv2.2",
                    weights.dimension("scratch.output_conv2.2.weight", 0), last);
}

FeatureMap VggtDenseHead::level(Compute& compute, const AggregatedTokens& tokens, int64_t frame,
                                size_t index) const {
  const Matrix& layer = tokens.layers[index];
  const int64_t patches = tokens.grid_height * tokens.grid_width;
  Matrix part(patches, layer.columns);
  copy_block(part.data, {}, layer.data, {(frame * tokens.per_frame() + tokens.special) * layer.columns, 0}, 1,
             patches * layer.columns);
  Matrix normed = norm_(compute, part);
  const DptLevel& level = levels_[index];
  FeatureMap map =
      level.project(compute, FeatureMap(tokens.grid_height, tokens.grid_width, std::move(normed)));
  add_uv_embedding(map, double(tokens.grid_width) / double(tokens.grid_height));
  return level.features(compute, level.resize(compute, std::move(map)));
}

FeatureMap VggtDenseHead::operator()(Compute& compute, const AggregatedTokens& tokens,
                                     int64_t frame) const {
  constexpr int64_t kPatch = 14;
  std::vector<FeatureMap> maps;
  for (size_t j = 0; j < levels_.size(); ++j) maps.push_back(level(compute, tokens, frame, j));
  FeatureMap out;
  for (size_t j = levels_.size(); j-- > 0;) {
    const Fusion& fusion = fusions_[j];
    if (j + 1 == levels_.size()) {
      out = std::move(maps[j]);
    } else {
      add_map(out, fusion.unit1(compute, maps[j]));
    }
    out = fusion.unit2(compute, out);
    const int64_t height = j > 0 ? maps[j - 1].height : 2 * out.height;
    const int64_t width = j > 0 ? maps[j - 1].width : 2 * out.width;
    // A 1x1 convolution and bilinear resizing commute (the weights of a resampling sum to one): the
    // convolution is done on the smaller map.
    out = resize_bilinear_map(compute, fusion.out(compute, out), height, width, true);
  }
  out = output1_(compute, out);
  out = resize_bilinear_map(compute, out, tokens.grid_height * kPatch, tokens.grid_width * kPatch,
                            true);
  add_uv_embedding(out, double(tokens.grid_width) / double(tokens.grid_height));
  out = output3_(compute, output2_(compute, out, {false, Activation::kRelu}));
  for (int64_t i = 0; i < out.places(); ++i) {
    float* v = out.data.data() + i * out.channels;
    for (int64_t c = 0; c + 1 < out.channels; ++c) v[c] = dense_value(activation_, v[c]);
    v[out.channels - 1] = dense_confidence(v[out.channels - 1]);
  }
  return out;
}

}  // namespace aligngs::nn
