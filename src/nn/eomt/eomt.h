// EoMT (Kerssies et al. 2025, "Your ViT is secretly an image segmentation model"): a DINOv2 transformer. Its last
// blocks also hold learned queries, each of which becomes a class and a mask.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/image.h"
#include "nn/vit.h"

namespace aligngs::nn {

/// Settings that the tensors do not hold.
struct EomtOptions {
  int64_t heads = 0;         ///< 0: channels / 64
  int64_t query_blocks = 0;  ///< last blocks that hold the queries; 0: as many as attn_mask_probs has
  /// Moments of RGB in [0, 1], if the file has no pixel_mean and pixel_std. The default is ImageNet's.
  std::array<float, 3> mean{0.485f, 0.456f, 0.406f}, deviation{0.229f, 0.224f, 0.225f};
};

/// The options in config.json and preprocessor_config.json beside a file of Hugging Face's layout; the defaults where
/// there are none. Error{kBadInput} when one is damaged.
EomtOptions eomt_options_beside(const std::filesystem::path& weights);

/// One window's queries.
struct EomtPrediction {
  Matrix classes;    ///< logits [queries, classes + 1]; the last is "no object"
  FeatureMap masks;  ///< logits [places at 1/4, queries]
};

/// For looking inside.
struct EomtInside {
  Matrix tokens_before;  ///< that enter the first block with queries, without them
  Matrix tokens_last;    ///< after the last block, not normed: queries, cls, registers, patches
  Matrix mask_embedding;
  FeatureMap upscaled;
};

class Eomt {
 public:
  /// `weights`: eomt_weights(). Error{kWeights} also when attention masks of training are still in use.
  Eomt(Compute& compute, const Weights& weights, const EomtOptions& options = {});

  int64_t classes() const { return class_head_.outputs() - 1; }
  int64_t queries() const { return queries_.rows; }
  /// Side of the square that the network takes, in pixels: it takes no other.
  int window() const { return window_; }

  /// An RGB window of exactly that size; Error{kBadInput} otherwise. inside: filled where it is not null.
  EomtPrediction operator()(Compute& compute, const Image<uint8_t>& window, EomtInside* inside = nullptr) const;

  /// Class logits, mask logits and all thresholds are float32 whatever the precision.
  Compute& exact() const { return *exact_; }

 private:
  struct Upscale {
    TransposedConvolution grow;
    DepthwiseConvolution mix;
    LayerNorm norm;
  };
  FeatureMap upscale(Compute& compute, const Upscale& step, const FeatureMap& x) const;
  void check_masks(const Weights& weights) const;

  std::unique_ptr<Compute> exact_;
  std::unique_ptr<Vit> vit_;
  EomtOptions options_;
  int window_ = 0;
  Matrix queries_;
  Linear class_head_, mask_head1_, mask_head2_, mask_head3_;
  std::vector<Upscale> upscale_;
};

}  // namespace aligngs::nn
