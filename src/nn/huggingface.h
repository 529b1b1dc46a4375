// Weights in the layout of Hugging Face's transformers, under the publisher's names.
#pragma once

#include <memory>

#include "nn/weights.h"

namespace aligngs::nn {

/// A DINOv2 backbone (facebook/dinov2-*); `prefix` is "" or "backbone.".
Weights dinov2_from_huggingface(const std::shared_ptr<const WeightFile>& file, const std::string& prefix = "");

/// The head of facebook/dpt-dinov2-*, as "decode_head.*". Tensors that its network never uses are
/// left out.
Weights dpt_head_from_huggingface(const std::shared_ptr<const WeightFile>& file);

/// Whether a file has that layout.
bool is_huggingface_dpt(const WeightFile& file);

}  // namespace aligngs::nn
