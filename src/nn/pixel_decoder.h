// Mask2Former's pixel decoder (Cheng et al. 2022): deformable attention over three scales.
#pragma once

#include <array>
#include <vector>

#include "nn/ops/convolution.h"
#include "nn/ops/deformable_attention.h"

namespace aligngs::nn {

class PixelDecoder {
 public:
  struct Options {
    int64_t groups = 32;  ///< of the group norms
    int64_t heads = 0;    ///< 0: from the tensors, with 4 points per level
  };
  /// `weights`: the tensors below "decode_head.pixel_decoder.".
  PixelDecoder(const Compute& compute, const Weights& weights, const Options& options);

  int64_t features() const { return features_; }
  int64_t heads() const { return layers_.front().attention.heads(); }

  struct Output {
    FeatureMap mask_features;            ///< at 1/4
    std::array<FeatureMap, 3> memories;  ///< at 1/32, 1/16, 1/8
  };
  /// Maps at 1/4, 1/8, 1/16, 1/32.
  Output operator()(Compute& compute, const std::array<FeatureMap, 4>& maps) const;

 private:
  struct Layer {
    DeformableAttention attention;
    LayerNorm norm1, norm2;
    Linear fc1, fc2;
  };
  int64_t features_ = 0;
  std::array<Linear, 3> inputs_;  ///< coarsest first
  std::array<GroupNorm, 3> input_norms_;
  std::vector<float> level_encoding_;  ///< [3, features]
  std::vector<Layer> layers_;
  Linear lateral_, mask_feature_;
  Convolution output_;
  GroupNorm lateral_norm_, output_norm_;
};

}  // namespace aligngs::nn
