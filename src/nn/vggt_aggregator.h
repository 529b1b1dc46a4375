// VGGT's trunk (Wang et al. 2025): attention within frames and across frames in turn.
#pragma once

#include <memory>
#include <vector>

#include "nn/vit.h"

namespace aligngs::nn {

/// Tokens of all frames after some of the layers.
struct AggregatedTokens {
  int64_t frames = 0, grid_height = 0, grid_width = 0;
  int64_t special = 0;         ///< camera and register tokens before the patches of a frame
  std::vector<Matrix> layers;  ///< [frames * per_frame, 2 * channels]: frame block | global block
  Matrix patch_tokens;         ///< of the image encoder; kept only when asked for

  int64_t per_frame() const { return special + grid_height * grid_width; }
};

class VggtAggregator {
 public:
  /// `weights`: the tensors below "aggregator.". heads == 0: channels / 64.
  VggtAggregator(const Compute& compute, const Weights& weights, int64_t heads = 0);

  int64_t depth() const { return int64_t(frame_blocks_.size()); }
  int64_t channels() const { return encoder_->channels(); }

  /// Images in [0, 1], one size, sides multiples of 14; the first frame defines the world.
  /// `keep`: layers to return.
  AggregatedTokens operator()(Compute& compute, std::vector<FeatureMap> images, const std::vector<int>& keep,
                              bool keep_patch_tokens = false) const;

 private:
  int64_t heads_ = 0;
  std::unique_ptr<Vit> encoder_;
  std::vector<TransformerBlock> frame_blocks_, global_blocks_;
  std::vector<float> special_[2];  ///< camera and register tokens of the first and of other frames
};

}  // namespace aligngs::nn
