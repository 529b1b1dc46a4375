// Weights of EoMT under one set of names, whichever layout a file has.
#pragma once

#include <memory>

#include "nn/weights.h"

namespace aligngs::nn {

/// The publisher's names without "network."; the backbone has the names of Vit. They are "encoder.backbone.*"
/// (register_tokens; mlp.w12 and mlp.w3 where the feed-forward part is gated), "q.weight", "class_head.*",
/// "mask_head.{0,2,4}.*", "upscale.N.{conv1,conv2,norm}.*", "attn_mask_probs", "encoder.pixel_mean",
/// "encoder.pixel_std". The tensors, not the file's name, distinguish the publisher's layout from Hugging Face's.
/// Error{kWeights} when the file has neither, or holds differences to a DINOv3 backbone, which has no position table.
Weights eomt_weights(const std::shared_ptr<const WeightFile>& file);

/// Whether a file has one of the two layouts.
bool is_eomt(const WeightFile& file);

}  // namespace aligngs::nn
