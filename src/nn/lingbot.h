// LingBot-Vision (robbyant 2026) with LibreYOLO's 1x1 head: a light teacher of ADE20K's classes.
#pragma once

#include <memory>
#include <optional>

#include "core/image.h"
#include "nn/segmentation.h"
#include "nn/vit.h"

namespace aligngs::nn {

inline constexpr int kLingbotSize = 512;  ///< pixels of the square to which photos are stretched

/// The tensors of a LibreYOLO file under the names that Vit has: "backbone.*" and "predict.*". Error{kWeights} when the
/// file holds a backbone alone, or another network.
Weights lingbot_weights(const std::shared_ptr<const WeightFile>& file);

/// Whether a file is one of LingBot-Vision with a head.
bool is_lingbot(const WeightFile& file);

class LingbotNetwork : public SegmentationNetwork {
 public:
  /// `weights`: lingbot_weights(). heads: 0: by the number of rotation periods.
  LingbotNetwork(const Compute& compute, const Weights& weights, int64_t heads = 0);

  int64_t classes() const override { return predict_.outputs(); }
  const Vit& vit() const { return *vit_; }

  /// Logits [height, width, classes] of a normalised image or window of that size, sides multiples of the patch.
  FeatureMap predict(Compute& compute, const FeatureMap& window) const override;
  /// The same on the grid of patches; tokens: filled where it is not null.
  FeatureMap grid_logits(Compute& compute, const FeatureMap& window, VitTokens* tokens = nullptr) const;

  /// Logits [height, width, classes] of a photo (RGB) as published: stretched to a square of `side` pixels, one
  /// resize back.
  FeatureMap photo_logits(Compute& compute, const Image<uint8_t>& photo, int64_t height, int64_t width,
                          int side = kLingbotSize) const;

 private:
  std::unique_ptr<Vit> vit_;
  Linear predict_;
};

}  // namespace aligngs::nn
