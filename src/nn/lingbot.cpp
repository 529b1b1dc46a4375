#include "nn/lingbot.h"

#include <algorithm>

#include "core/error.h"
#include "nn/ops/resize.h"
#include "nn/preprocess/normalised_image.h"
#include "nn/preprocess/opencv_resize.h"
#include "nn/rename.h"

namespace aligngs::nn {
namespace {

constexpr float kLingbotNormEps = 1e-5f;  // unlike DINOv2's

std::string known_name(std::string name) {
  while (replace_part(name, "_orig_mod.", "")) {
  }
  replace_start(name, "backbone.storage_tokens", "backbone.register_tokens");
  return name;
}

VitOptions vit_options(const Weights& backbone, int64_t heads) {
  const int64_t periods = backbone.dimension("rope_embed.periods", 0);
  const int64_t channels = backbone.dimension("patch_embed.proj.weight", 0);
  VitOptions options;
  options.heads = heads > 0 ? heads : channels / std::max<int64_t>(4 * periods, 1);
  options.position = PositionRule::kNone;
  options.eps = kLingbotNormEps;
  options.rotated = true;
  // Stored biases of keys are not 0 but do not count: without the mask the network would run, and be wrong.
  if (backbone.has("blocks.0.attn.qkv.bias")) backbone.shape("blocks.0.attn.qkv.bias_mask");  // throws: missing
  return options;
}

bool has_tensor(const WeightFile& file, const std::string& name) {
  for (const auto& tensor : file.tensors()) {
    if (known_name(tensor.first) == name) return true;
  }
  return false;
}

}  // namespace

bool is_lingbot(const WeightFile& file) {
  return has_tensor(file, "backbone.rope_embed.periods") && has_tensor(file, "backbone.register_tokens") &&
         has_tensor(file, "predict.weight");
}

Weights lingbot_weights(const std::shared_ptr<const WeightFile>& file) {
  if (!is_lingbot(*file)) {
    const bool bare = has_tensor(*file, "rope_embed.periods") || has_tensor(*file, "backbone.rope_embed.periods");
    throw Error({ErrorKind::kWeights,
                 bare ? "the file holds the backbone alone, without its segmentation head"
                      : "these are not the weights of LingBot-Vision with a segmentation head",
                 file->name(), "predict.weight", "use LibreYOLO's file LibreLingBotVisions-sem.pt"});
  }
  Weights weights;
  weights.add_all(file, known_name);
  return weights;
}

LingbotNetwork::LingbotNetwork(const Compute& compute, const Weights& weights, int64_t heads) {
  const Weights backbone = weights.sub("backbone.");
  vit_ = std::make_unique<Vit>(compute, backbone, vit_options(backbone, heads));
  backbone.shape("norm.weight");  // throws: missing
  predict_ = Linear(compute, weights, "predict", weights.dimension("predict.weight", 0), vit_->channels());
}

FeatureMap LingbotNetwork::grid_logits(Compute& compute, const FeatureMap& window, VitTokens* tokens) const {
  VitTokens found = (*vit_)(compute, {window});
  FeatureMap logits = predict_(compute, found.patches(vit_->normed(compute, found.tokens)));
  if (tokens) *tokens = std::move(found);
  return logits;
}

FeatureMap LingbotNetwork::predict(Compute& compute, const FeatureMap& window) const {
  return resize_bilinear_map(compute, grid_logits(compute, window), window.height, window.width, false);
}

FeatureMap LingbotNetwork::photo_logits(Compute& compute, const Image<uint8_t>& photo, int64_t height, int64_t width,
                                        int side) const {
  const FeatureMap logits = grid_logits(compute, normalised_image(opencv_resize_linear(photo, side, side)));
  return resize_bilinear_map(compute, logits, height, width, false);
}

}  // namespace aligngs::nn
