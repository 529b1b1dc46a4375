#include "nn/vggt.h"

#include <algorithm>

#include "core/error.h"

namespace aligngs::nn {

Vggt::Vggt(Compute& compute, const Weights& weights, const VggtOptions& options) : layers_(options.layers) {
  exact_ = std::make_unique<Compute>(compute.pool());
  aggregator_.emplace(compute, weights.sub("aggregator."), options.heads);
  camera_head_.emplace(*exact_, weights.sub("camera_head."), options.camera_heads);
  if (weights.has("depth_head.norm.weight"))
    depth_head_.emplace(compute, weights.sub("depth_head."), DenseActivation::kDepth);
  if (weights.has("point_head.norm.weight"))
    point_head_.emplace(compute, weights.sub("point_head."), DenseActivation::kPoints);
  if (layers_.empty()) {
    const int depth = int(aggregator_->depth());
    for (const int of_24 : {4, 11, 17, 23}) layers_.push_back((of_24 + 1) * depth / 24 - 1);
  }
  for (const int layer : layers_) {
    if (layers_.size() != 4 || layer < 0 || layer >= int(aggregator_->depth()))
      throw_usage("the dense heads need four layers of the trunk", "correct the list of layers");
  }
}

Matrix Vggt::camera_tokens(const AggregatedTokens& tokens) {
  const Matrix& last = tokens.layers.back();
  Matrix out(tokens.frames, last.columns);
  for (int64_t f = 0; f < tokens.frames; ++f) std::copy_n(last.row(f * tokens.per_frame()), last.columns, out.row(f));
  return out;
}

void Vggt::operator()(Compute& compute, std::vector<FeatureMap> images, const VggtRequest& request,
                      const std::function<void(int64_t, VggtFrame)>& take) const {
  if ((request.depth && !depth_head_) || (request.points && !point_head_)) {
    throw Error({ErrorKind::kWeights,
                 "the weights of this head are missing",
                 {},
                 request.depth && !depth_head_ ? "depth_head" : "point_head",
                 "use the complete file of weights"});
  }
  std::vector<int> keep = layers_;
  keep.push_back(int(aggregator_->depth()) - 1);  // what the camera head reads
  if (layers_.back() == keep.back()) keep.pop_back();
  const AggregatedTokens tokens = (*aggregator_)(compute, std::move(images), keep);
  const std::vector<PoseEncoding> poses = (*camera_head_)(*exact_, camera_tokens(tokens)).back();
  constexpr int64_t kPatch = 14;
  for (int64_t f = 0; f < tokens.frames; ++f) {
    VggtFrame frame;
    frame.camera = decode_pose(poses[size_t(f)], tokens.grid_width * kPatch, tokens.grid_height * kPatch);
    if (request.depth) frame.depth = (*depth_head_)(compute, tokens, f);
    if (request.points) frame.points = (*point_head_)(compute, tokens, f);
    take(f, std::move(frame));
  }
}

FeatureMap unproject_depth(const FeatureMap& depth, const VggtCamera& camera) {
  FeatureMap points(depth.height, depth.width, 3);
  for (int64_t v = 0; v < depth.height; ++v) {
    for (int64_t u = 0; u < depth.width; ++u) {
      const double z = double(depth.at(v, u)[0]);
      const double p[3] = {(double(u) - camera.cx) * z / camera.fx - camera.translation[0],
                           (double(v) - camera.cy) * z / camera.fy - camera.translation[1], z - camera.translation[2]};
      for (size_t i = 0; i < 3; ++i) {
        points.at(v, u)[i] =
            float(camera.rotation[i] * p[0] + camera.rotation[3 + i] * p[1] + camera.rotation[6 + i] * p[2]);
      }
    }
  }
  return points;
}

}  // namespace aligngs::nn
