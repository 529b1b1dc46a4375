// The tensors of EoMT and of LingBot-Vision.
#include "nn/tensor_names.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kLabelPatch = 16;

struct UpscaleNames {
  std::string prefix, norm;
};

void add_upscale(TensorNames& names, const UpscaleNames& as, int64_t c) {
  for (int i = 0; i < 2; ++i) {
    const std::string p = as.prefix + std::to_string(i) + ".";
    names.convolution(p + "conv1", c, c, 2);
    names.add(p + "conv2.weight", {c, 1, 3, 3});
    names.norm(p + as.norm, c);
  }
}

}  // namespace

TensorList eomt_tensors(const EomtSize& size) {
  TensorNames names("");
  const int64_t c = size.encoder.channels, hidden = size.encoder.hidden();
  const std::string b = "network.encoder.backbone.";
  names.add("network.attn_mask_probs", {size.query_blocks});
  names.add("network.encoder.pixel_mean", {1, 3, 1, 1});
  names.add("network.encoder.pixel_std", {1, 3, 1, 1});
  names.add(b + "cls_token", {1, 1, c});
  names.add(b + "reg_token", {1, size.encoder.registers, c});
  names.add(b + "pos_embed", {1, size.encoder.grid * size.encoder.grid, c});
  names.convolution(b + "patch_embed.proj", c, 3, kLabelPatch);
  for (int64_t i = 0; i < size.encoder.depth; ++i)
    add_block(names, b + "blocks." + std::to_string(i) + ".", {c, hidden});
  names.norm(b + "norm", c);
  names.add("network.q.weight", {size.queries, c});
  names.linear("network.class_head", size.classes + 1, c);
  for (const char* const n : {"0", "2", "4"}) names.linear(std::string("network.mask_head.") + n, c, c);
  add_upscale(names, {"network.upscale.", "norm"}, c);
  names.add("criterion.empty_weight", {size.classes + 1});
  return names.list;
}

TensorList eomt_huggingface_tensors(const EomtSize& size) {
  TensorNames names("");
  const int64_t c = size.encoder.channels, hidden = size.encoder.hidden();
  names.add("attn_mask_probs", {size.query_blocks});
  names.add("embeddings.cls_token", {1, 1, c});
  names.add("embeddings.register_tokens", {1, size.encoder.registers, c});
  names.add("embeddings.position_embeddings.weight", {size.encoder.grid * size.encoder.grid, c});
  names.convolution("embeddings.patch_embeddings.projection", c, 3, kLabelPatch);
  for (int64_t i = 0; i < size.encoder.depth; ++i) {
    const std::string p = "layers." + std::to_string(i) + ".";
    names.norm(p + "norm1", c);
    for (const char* const n : {"q_proj", "k_proj", "v_proj", "out_proj"}) names.linear(p + "attention." + n, c, c);
    names.add(p + "layer_scale1.lambda1", {c});
    names.norm(p + "norm2", c);
    names.linear(p + "mlp.fc1", hidden, c);
    names.linear(p + "mlp.fc2", c, hidden);
    names.add(p + "layer_scale2.lambda1", {c});
  }
  names.norm("layernorm", c);
  names.add("query.weight", {size.queries, c});
  names.linear("class_predictor", size.classes + 1, c);
  for (const char* const n : {"fc1", "fc2", "fc3"}) names.linear(std::string("mask_head.") + n, c, c);
  add_upscale(names, {"upscale_block.block.", "layernorm2d"}, c);
  names.add("criterion.empty_weight", {size.classes + 1});
  return names.list;
}

TensorList lingbot_tensors(const LingbotSize& size) {
  TensorNames names("");
  const int64_t c = size.encoder.channels;
  names.add("backbone.cls_token", {1, 1, c});
  names.add("backbone.storage_tokens", {1, size.encoder.registers, c});
  names.add("backbone.mask_token", {1, c});
  names.convolution("backbone.patch_embed.proj", c, 3, kLabelPatch);
  names.add("backbone.rope_embed.periods", {c / size.heads / 4});
  for (int64_t i = 0; i < size.encoder.depth; ++i) {
    const std::string p = "backbone.blocks." + std::to_string(i) + ".";
    add_block(names, p, {c, size.encoder.hidden()});
    names.add(p + "attn.qkv.bias_mask", {3 * c});
  }
  names.norm("backbone.norm", c);
  names.convolution("predict", size.classes, c, 1);
  return names.list;
}

}  // namespace aligngs::nn
