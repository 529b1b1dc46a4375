// Names: the publisher's LightningModule, and transformers' convert_eomt_to_hf.py.
#include "nn/eomt/eomt_weights.h"

#include <utility>

#include "core/error.h"
#include "nn/rename.h"

namespace aligngs::nn {
namespace {

using NamePair = std::pair<const char*, const char*>;

const std::string kBackbone = "encoder.backbone.";

std::string official_name(std::string name) {
  while (replace_part(name, "_orig_mod.", "")) {
  }
  replace_start(name, "network.", "");
  replace_start(name, kBackbone + "reg_token", kBackbone + "register_tokens");
  return name;
}

/// The part of queries, keys and values is left to add_joined().
std::string huggingface_name(std::string name) {
  for (const NamePair& p : {NamePair("embeddings.patch_embeddings.projection.", "encoder.backbone.patch_embed.proj."),
                            NamePair("embeddings.position_embeddings.weight", "encoder.backbone.pos_embed"),
                            NamePair("embeddings.", "encoder.backbone."),
                            NamePair("layernorm.", "encoder.backbone.norm."), NamePair("query.", "q."),
                            NamePair("class_predictor.", "class_head."), NamePair("mask_head.fc1.", "mask_head.0."),
                            NamePair("mask_head.fc2.", "mask_head.2."), NamePair("mask_head.fc3.", "mask_head.4.")}) {
    if (replace_start(name, p.first, p.second)) return name;
  }
  if (replace_start(name, "upscale_block.block.", "upscale.")) {
    replace_part(name, ".layernorm2d.", ".norm.");
    return name;
  }
  if (!replace_start(name, "layers.", kBackbone + "blocks.")) return name;
  for (const NamePair& p :
       {NamePair(".attention.out_proj.", ".attn.proj."), NamePair(".layer_scale1.lambda1", ".ls1.gamma"),
        NamePair(".layer_scale2.lambda1", ".ls2.gamma"), NamePair(".mlp.weights_in.", ".mlp.w12."),
        NamePair(".mlp.weights_out.", ".mlp.w3.")}) {
    if (replace_part(name, p.first, p.second)) return name;
  }
  return name;
}

/// Queries, keys and values become one tensor; false when `name` is none of theirs.
bool add_joined(Weights& weights, const std::shared_ptr<const WeightFile>& file, const std::string& name) {
  const std::string middle = ".attention.q_proj.";
  const size_t at = name.find(middle);
  if (at == std::string::npos)
    return name.find(".attention.k_proj.") != std::string::npos || name.find(".attention.v_proj.") != std::string::npos;
  const std::string tail = name.substr(at + middle.size());
  std::vector<std::string> parts;
  for (const char* const part : {"q_proj.", "k_proj.", "v_proj."})
    parts.push_back(name.substr(0, at) + ".attention." + part + tail);
  std::string block = name.substr(0, at);
  replace_start(block, "layers.", kBackbone + "blocks.");
  weights.add(block + ".attn.qkv." + tail, file, parts);
  return true;
}

/// fc1 that is twice as wide as what fc2 reads holds both halves of a gate.
bool is_gated(const Weights& weights) {
  const std::string block = kBackbone + "blocks.0.mlp.";
  if (!weights.has(block + "fc1.weight") || !weights.has(block + "fc2.weight")) return false;
  return weights.dimension(block + "fc1.weight", 0) == 2 * weights.dimension(block + "fc2.weight", 1);
}

bool has(const WeightFile& file, const std::string& name) { return file.tensors().count(name) > 0; }

bool is_huggingface(const WeightFile& file) { return has(file, "query.weight") && has(file, "class_predictor.weight"); }

bool is_official(const WeightFile& file) {
  for (const auto& tensor : file.tensors()) {
    if (official_name(tensor.first) == "q.weight") return true;
  }
  return false;
}

}  // namespace

bool is_eomt(const WeightFile& file) { return is_huggingface(file) || is_official(file); }

Weights eomt_weights(const std::shared_ptr<const WeightFile>& file) {
  const bool huggingface = is_huggingface(*file);
  if (!huggingface && !is_official(*file)) {
    throw Error({ErrorKind::kWeights, "the file has no learned queries, in neither layout of EoMT", file->name(),
                 "network.q.weight or query.weight", "use a file of tue-mps/ade20k_semantic_eomt_large_512 or alike"});
  }
  const auto read_names = [&](bool gated) {
    Weights weights;
    for (const auto& tensor : file->tensors()) {
      if (huggingface && add_joined(weights, file, tensor.first)) continue;
      std::string name = huggingface ? huggingface_name(tensor.first) : official_name(tensor.first);
      if (gated && !replace_part(name, ".mlp.fc1.", ".mlp.w12.")) replace_part(name, ".mlp.fc2.", ".mlp.w3.");
      weights.add(name, file, {tensor.first});
    }
    return weights;
  };
  Weights weights = read_names(false);
  if (!weights.has(kBackbone + "pos_embed")) {
    throw Error({ErrorKind::kWeights,
                 "the file has no table of positions; it may hold differences to a DINOv3 backbone, another network",
                 file->name(), kBackbone + "pos_embed", "use a file of EoMT on DINOv2"});
  }
  return is_gated(weights) ? read_names(true) : weights;
}

}  // namespace aligngs::nn
