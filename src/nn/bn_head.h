// DINOv2's linear and multi-scale segmentation heads.
#pragma once

#include "nn/segmentation.h"
#include "nn/vit.h"

namespace aligngs::nn {

struct BnHeadOptions {
  VitOptions vit;
  std::vector<int> layers;    ///< of the backbone; empty: its last four
  std::vector<int> in_index;  ///< of `layers`; empty: the last, or all, by the width of the head
};

/// Normed maps of the chosen layers side by side -> batch norm -> 1x1 convolution.
class BnHeadNetwork : public SegmentationNetwork {
 public:
  /// backbone: a plain DINOv2 file; head: tensors "decode_head.*".
  BnHeadNetwork(const Compute& compute, const Weights& backbone, const Weights& head,
                const BnHeadOptions& options = {});

  int64_t classes() const override { return classify_.outputs(); }
  FeatureMap predict(Compute& compute, const FeatureMap& window) const override;
  /// Logits on the grid of patches of the image, padded to a multiple of the patch.
  FeatureMap grid_logits(Compute& compute, const FeatureMap& image) const;

 private:
  Vit vit_;
  std::vector<int> layers_;  ///< those the head reads, in its order
  Linear classify_;          ///< with the batch norm folded in
};

}  // namespace aligngs::nn
