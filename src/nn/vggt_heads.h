// VGGT's heads: cameras from the camera tokens, dense maps from the patch tokens.
#pragma once

#include <vector>

#include "nn/dpt_pyramid.h"
#include "nn/vggt_aggregator.h"
#include "nn/vggt_pose.h"

namespace aligngs::nn {

/// Refines all cameras together in four iterations.
class VggtCameraHead {
 public:
  /// `weights`: the tensors below "camera_head.". heads == 0: channels / 128.
  VggtCameraHead(const Compute& compute, const Weights& weights, int64_t heads = 0);

  /// camera_tokens [frames, 2 * channels]: token 0 of each frame of the last layer. One list of
  /// encodings per iteration; the last one counts.
  std::vector<std::vector<PoseEncoding>> operator()(Compute& compute, const Matrix& camera_tokens) const;

 private:
  int64_t channels_ = 0;
  std::vector<float> empty_pose_;
  LayerNorm token_norm_, trunk_norm_;
  Linear embed_pose_, modulation_, branch1_, branch2_;
  std::vector<TransformerBlock> trunk_;
};

/// How the outputs of a dense head become values; the last channel is always a confidence,
/// 1 + exp(c).
enum class DenseActivation {
  kDepth,  ///< exp(v)
  kPoints  ///< sign(v) (exp(|v|) - 1)
};

float dense_value(DenseActivation activation, float v);
float dense_confidence(float v);

class VggtDenseHead {
 public:
  /// `weights`: the tensors below "depth_head." or "point_head.".
  VggtDenseHead(const Compute& compute, const Weights& weights, DenseActivation activation);

  /// The map of one frame at the resolution of the image; layers: the four of the aggregator,
  /// finest level first.
  FeatureMap operator()(Compute& compute, const AggregatedTokens& tokens, int64_t frame) const;

 private:
  DenseActivation activation_;
  DptPyramid pyramid_;
  DptFusion fusion_;
  Convolution output1_, output2_;
  Linear output3_;
};

}  // namespace aligngs::nn
