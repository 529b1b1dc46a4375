// Mask2Former on a ViT-Adapter backbone (dinov2_vitg14_ade20k_m2f).
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "nn/multihead_attention.h"
#include "nn/pixel_decoder.h"
#include "nn/segmentation.h"
#include "nn/vit_adapter.h"

namespace aligngs::nn {

/// Settings that the tensors do not hold. The defaults are those of mmsegmentation's
/// configurations.
struct Mask2FormerOptions {
  AdapterOptions adapter;
  int64_t heads = 0;    ///< of the head; 0: as many as the pixel decoder's deformable attention has
  int64_t groups = 32;  ///< of the group norms
};

class Mask2Former : public SegmentationNetwork {
 public:
  /// One file: "backbone.*" and "decode_head.*".
  Mask2Former(Compute& compute, const Weights& weights, const Mask2FormerOptions& options = {});

  int64_t classes() const override { return class_embed_.outputs() - 1; }
  const VitAdapter& backbone() const { return backbone_; }
  const PixelDecoder& pixel_decoder() const { return *pixel_decoder_; }

  /// Scores of about [0, 1] per class. A window whose sides are no multiples of 32 is resized to
  /// them and back.
  FeatureMap predict(Compute& compute, const FeatureMap& window) const override;
  /// The same at 1/4 of a window whose sides are multiples of 32.
  FeatureMap quarter_scores(Compute& compute, const FeatureMap& window) const;

  /// Class logits [queries, classes + 1] and mask logits [places, queries] at 1/4.
  struct Prediction {
    Matrix classes;
    FeatureMap masks;
  };
  /// For looking inside; both may be empty.
  struct DecodingHooks {
    /// Is given the prediction before the first layer (0) and after each.
    std::function<void(int, const Prediction&)> visit;
    /// Mask logits at 1/4 that layer n (from 0) is to use in place of the network's own. Attention
    /// masks are a threshold of them, so that the smallest rounding can change what follows.
    std::function<FeatureMap(int)> masks;
  };
  Prediction decode(Compute& compute, const PixelDecoder::Output& pixels) const {
    return decode(compute, pixels, DecodingHooks());
  }
  Prediction decode(Compute& compute, const PixelDecoder::Output& pixels, const DecodingHooks& hooks) const;
  FeatureMap scores_of(const Prediction& prediction) const;

 private:
  struct Layer {
    MultiheadAttention cross, self;
    LayerNorm norm1, norm2, norm3;
    Linear fc1, fc2;
  };
  Matrix mask_embedding(Compute& compute, const Matrix& normed) const;
  FeatureMap mask_logits(const Matrix& embedding, const FeatureMap& features) const;

  std::unique_ptr<Compute> exact_;  ///< the decoder is float32: signs of mask logits decide
  VitAdapter backbone_;
  std::unique_ptr<PixelDecoder> pixel_decoder_;
  Matrix query_feat_, query_embed_;
  std::vector<float> level_embed_;  ///< [3, features]
  std::vector<Layer> layers_;
  LayerNorm post_norm_;
  Linear class_embed_, mask_embed1_, mask_embed2_, mask_embed3_;
};

}  // namespace aligngs::nn
