// Depth Anything 3's two small networks for cameras: given ones become tokens, a token of the trunk becomes a camera.
#pragma once

#include <vector>

#include "nn/da3/cameras.h"
#include "nn/transformer_block.h"

namespace aligngs::nn {

/// Given cameras to camera tokens. It works in float32 whatever the precision, as the publisher's does.
class Da3CameraEncoder {
 public:
  /// `weights`: the tensors below "cam_enc.". heads: of its blocks, which the tensors do not tell.
  Da3CameraEncoder(const Compute& compute, const Weights& weights, int64_t heads);

  /// encodings [views, 9] -> [views, channels].
  Matrix operator()(Compute& compute, const std::vector<PoseEncoding>& encodings) const;

 private:
  Linear fc1_, fc2_;
  LayerNorm token_norm_, trunk_norm_;
  std::vector<TransformerBlock> trunk_;
};

/// Camera tokens of the trunk to encodings of cameras.
class Da3CameraDecoder {
 public:
  /// `weights`: the tensors below "cam_dec."; width: of a token.
  Da3CameraDecoder(const Compute& compute, const Weights& weights, int64_t width);

  /// tokens [views, width].
  std::vector<PoseEncoding> operator()(Compute& compute, const Matrix& tokens) const;

 private:
  Linear fc1_, fc2_, translation_, quaternion_, fields_;
};

}  // namespace aligngs::nn
