#include "nn/da3/camera_branch.h"

#include <algorithm>

namespace aligngs::nn {
namespace {

constexpr float kCameraNormEps = 1e-5f;
constexpr int64_t kPose = 9;

}  // namespace

Da3CameraEncoder::Da3CameraEncoder(const Compute& compute, const Weights& weights, int64_t heads) {
  const int64_t c = weights.dimension("token_norm.weight", 0);
  const int64_t hidden = weights.dimension("pose_branch.fc1.weight", 0);
  fc1_ = Linear(compute, weights, "pose_branch.fc1", hidden, kPose);
  fc2_ = Linear(compute, weights, "pose_branch.fc2", c, hidden);
  token_norm_ = LayerNorm(weights, "token_norm", c, kCameraNormEps);
  trunk_norm_ = LayerNorm(weights, "trunk_norm", c, kCameraNormEps);
  for (int i = 0; i < weights.count("trunk."); ++i) {
    trunk_.emplace_back(compute, weights.sub("trunk." + std::to_string(i) + "."),
                        TransformerBlock::Config{c, heads, kCameraNormEps});
  }
}

Matrix Da3CameraEncoder::operator()(Compute& compute, const std::vector<PoseEncoding>& encodings) const {
  Matrix poses(int64_t(encodings.size()), kPose);
  for (size_t i = 0; i < encodings.size(); ++i)
    std::copy(encodings[i].begin(), encodings[i].end(), poses.row(int64_t(i)));
  Matrix x = token_norm_(compute, fc2_(compute, fc1_(compute, poses, Activation::kGelu)));
  for (const TransformerBlock& block : trunk_) block.forward(compute, x, 1);
  return trunk_norm_(compute, x);
}

Da3CameraDecoder::Da3CameraDecoder(const Compute& compute, const Weights& weights, int64_t width)
    : fc1_(compute, weights, "backbone.0", width, width),
      fc2_(compute, weights, "backbone.2", width, width),
      translation_(compute, weights, "fc_t", 3, width),
      quaternion_(compute, weights, "fc_qvec", 4, width),
      fields_(compute, weights, "fc_fov.0", 2, width) {}

std::vector<PoseEncoding> Da3CameraDecoder::operator()(Compute& compute, const Matrix& tokens) const {
  const Matrix z = fc2_(compute, fc1_(compute, tokens, Activation::kRelu), Activation::kRelu);
  const Matrix translation = translation_(compute, z), quaternion = quaternion_(compute, z);
  const Matrix fields = fields_(compute, z, Activation::kRelu);
  std::vector<PoseEncoding> out(size_t(tokens.rows));
  for (int64_t i = 0; i < tokens.rows; ++i) {
    auto to = std::copy_n(translation.row(i), 3, out[size_t(i)].begin());
    to = std::copy_n(quaternion.row(i), 4, to);
    std::copy_n(fields.row(i), 2, to);
  }
  return out;
}

}  // namespace aligngs::nn
