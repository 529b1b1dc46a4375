// Names: transformers' convert_dinov2_to_hf.py and convert_dinov2_depth_to_hf.py.
#include "nn/huggingface.h"

#include <utility>

#include "nn/rename.h"

namespace aligngs::nn {
namespace {

std::string backbone_name(std::string name) {
  using Pair = std::pair<const char*, const char*>;
  for (const Pair& p :
       {Pair("embeddings.patch_embeddings.projection.", "patch_embed.proj."),
        Pair("embeddings.position_embeddings", "pos_embed"), Pair("embeddings.", ""), Pair("layernorm.", "norm.")}) {
    if (replace_start(name, p.first, p.second)) return name;
  }
  if (!replace_start(name, "encoder.layer.", "blocks.")) return "";
  for (const Pair& p : {Pair(".attention.output.dense.", ".attn.proj."), Pair(".layer_scale1.lambda1", ".ls1.gamma"),
                        Pair(".layer_scale2.lambda1", ".ls2.gamma"), Pair(".mlp.weights_in.", ".mlp.w12."),
                        Pair(".mlp.weights_out.", ".mlp.w3.")}) {
    if (replace_part(name, p.first, p.second)) return name;
  }
  return name;
}

std::string head_name(std::string name) {
  using Pair = std::pair<const char*, const char*>;
  if (replace_start(name, "neck.reassemble_stage.layers.", "reassemble_blocks.")) {
    const size_t dot = name.find('.', std::string("reassemble_blocks.").size());
    const size_t start = std::string("reassemble_blocks.").size();
    const std::string level = name.substr(start, dot - start), rest = name.substr(dot + 1);
    std::string out = rest;
    if (replace_start(out, "projection.", "reassemble_blocks.projects." + level + ".conv.")) return out;
    return replace_start(out, "resize.", "reassemble_blocks.resize_layers." + level + ".") ? out : "";
  }
  if (replace_start(name, "neck.reassemble_stage.readout_projects.", "reassemble_blocks.readout_projects."))
    return name;
  if (replace_start(name, "neck.convs.", "convs.")) {
    replace_part(name, ".weight", ".conv.weight");
    return name;
  }
  if (replace_start(name, "head.projection.", "project.conv.")) return name;
  if (replace_start(name, "head.head.", "conv_depth.head.")) return name;
  if (!replace_start(name, "neck.fusion_stage.layers.", "fusion_blocks.")) return "";
  if (replace_start(name, "fusion_blocks.0.residual_layer1.", "")) return "";  // random, unused
  if (replace_part(name, ".projection.", ".project.conv.")) return name;
  for (const Pair& p : {Pair(".residual_layer1.", ".res_conv_unit1."), Pair(".residual_layer2.", ".res_conv_unit2.")}) {
    if (replace_part(name, p.first, p.second)) break;
  }
  for (const Pair& p : {Pair(".convolution1.", ".conv1.conv."), Pair(".convolution2.", ".conv2.conv.")}) {
    if (replace_part(name, p.first, p.second)) return name;
  }
  return "";
}

}  // namespace

Weights dinov2_from_huggingface(const std::shared_ptr<const WeightFile>& file, const std::string& prefix) {
  Weights weights;
  const std::string query = ".attention.attention.query.";
  for (const auto& tensor : file->tensors()) {
    std::string name = tensor.first;
    if (!replace_start(name, prefix, "")) continue;
    const size_t at = name.find(query);
    if (at != std::string::npos) {  // query, key and value become one tensor
      const std::string tail = name.substr(at + query.size());
      std::vector<std::string> parts;
      for (const char* const part : {"query.", "key.", "value."}) {
        parts.push_back(prefix + name.substr(0, at) + ".attention.attention." + part + tail);
      }
      std::string block = name.substr(0, at);
      if (replace_start(block, "encoder.layer.", "blocks.")) weights.add(block + ".attn.qkv." + tail, file, parts);
      continue;
    }
    if (name.find(".attention.attention.") != std::string::npos) continue;
    const std::string known = backbone_name(name);
    if (!known.empty()) weights.add(known, file, {tensor.first});
  }
  return weights;
}

Weights dpt_head_from_huggingface(const std::shared_ptr<const WeightFile>& file) {
  Weights weights;
  weights.add_all(file, [](const std::string& name) {
    const std::string known = head_name(name);
    return known.empty() ? known : "decode_head." + known;
  });
  return weights;
}

bool is_huggingface_dpt(const WeightFile& file) { return file.tensors().count("neck.convs.0.weight") > 0; }

}  // namespace aligngs::nn
