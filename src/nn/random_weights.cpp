#include "nn/random_weights.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "nn/tensor_names.h"

namespace aligngs::nn {
namespace {

bool ends_with(const std::string& name, const std::string& end) {
  return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

/// Values are uniform around `mean`, `spread` to either side.
struct Distribution {
  double mean = 0, spread = 0;
};

Distribution distribution_of(const std::string& name, const std::vector<int64_t>& shape) {
  // Small steps from the bias below: cameras that photographs could have.
  if (ends_with(name, "pose_branch.fc2.weight") || name.find("cam_dec.fc_") != std::string::npos) return {0, 0.002};
  if (ends_with(name, "pixel_mean")) return {0.45, 0.03};
  if (ends_with(name, "pixel_std")) return {0.225, 0.003};
  if (ends_with(name, "running_var") || (ends_with(name, ".weight") && shape.size() == 1)) return {1, 0.1};
  if (name.find("gamma") != std::string::npos) return {0.1, 0.02};
  if (shape.size() == 1) return {0, 0.02};  // biases, running means
  double inputs = 1;
  for (size_t i = 1; i < shape.size(); ++i) inputs *= double(shape[i]);
  // Variance 1 / inputs.
  return {0, std::sqrt(3 / std::max(inputs, 1.0))};
}

/// Values with a meaning: no attention masks, the periods of a rotation, cameras near the identity. Fields of view are
/// 1 and 1.2 rad; the four iterations of VGGT's camera head add a quarter each.
void set_fixed_values(const SafetensorsStream::Entry& tensor, std::vector<float>& values) {
  const auto near = [&](const std::vector<float>& wanted) {
    for (size_t i = 0; i < std::min(wanted.size(), values.size()); ++i) values[i] = wanted[i] + 0.1f * values[i];
  };
  if (ends_with(tensor.name, "camera_head.pose_branch.fc2.bias")) near({0, 0, 0, 0, 0, 0, 0.25f, 0.25f, 0.3f});
  if (ends_with(tensor.name, "cam_dec.fc_qvec.bias")) near({0, 0, 0, 1});
  if (ends_with(tensor.name, "cam_dec.fc_fov.0.bias")) near({1, 1.2f});
  if (ends_with(tensor.name, "attn_mask_probs")) std::fill(values.begin(), values.end(), 0.0f);
  if (ends_with(tensor.name, "bias_mask")) {
    for (size_t i = 0; i < values.size(); ++i) values[i] = i / (values.size() / 3) == 1 ? 0.0f : 1.0f;  // no keys
  }
  if (ends_with(tensor.name, "rope_embed.periods")) {
    constexpr double kBase = 100;
    for (size_t i = 0; i < values.size(); ++i) values[i] = float(std::pow(kBase, double(i) / double(values.size())));
  }
}

void add_dense_head(TensorNames& names, const std::string& p, const VggtSize& size, int64_t outputs) {
  const int64_t inputs = 2 * size.encoder.channels, f = size.features;
  names.norm(p + "norm", inputs);
  add_pyramid(names, p, {inputs, f, size.levels, ""});
  constexpr int64_t kLast = 32;
  names.convolution(p + "scratch.output_conv1", f / 2, f, 3);
  names.convolution(p + "scratch.output_conv2.0", kLast, f / 2, 3);
  names.convolution(p + "scratch.output_conv2.2", outputs, kLast, 1);
}

struct DeformableSize {
  int64_t channels, inner, heads, levels;
};

void add_deformable(TensorNames& names, const std::string& p, const DeformableSize& d) {
  constexpr int64_t kPoints = 4;
  const int64_t samples = d.heads * d.levels * kPoints;
  names.linear(p + "sampling_offsets", 2 * samples, d.channels);
  names.linear(p + "attention_weights", samples, d.channels);
  names.linear(p + "value_proj", d.inner, d.channels);
  names.linear(p + "output_proj", d.channels, d.inner);
}

void add_adapter(TensorNames& names, const Mask2FormerSize& size) {
  const int64_t c = size.backbone.channels, s = size.inplane;
  names.add("level_embed", {3, c});
  const int64_t widths[] = {s, 2 * s, 4 * s, 4 * s};
  for (int i = 0; i < 3; ++i) {
    const std::string stem = "spm.stem.";
    names.convolution(stem + std::to_string(3 * i), s, i == 0 ? 3 : s, 3, false);
    names.batch_norm(stem + std::to_string(3 * i + 1), s);
    const std::string down = "spm.conv" + std::to_string(i + 2);
    names.convolution(down + ".0", widths[i + 1], widths[i], 3, false);
    names.batch_norm(down + ".1", widths[i + 1]);
  }
  for (int i = 0; i < 4; ++i) names.convolution("spm.fc" + std::to_string(i + 1), c, widths[i], 1);
  constexpr int kInteractions = 4;
  for (int i = 0; i < kInteractions; ++i) {
    const std::string p = "interactions." + std::to_string(i) + ".";
    names.add(p + "injector.gamma", {c});
    names.norm(p + "injector.query_norm", c);
    names.norm(p + "injector.feat_norm", c);
    add_deformable(names, p + "injector.attn.", {c, c / 2, size.deform_heads, 3});
    std::vector<std::string> extractors = {p + "extractor."};
    if (i == kInteractions - 1) {
      extractors.push_back(p + "extra_extractors.0.");
      extractors.push_back(p + "extra_extractors.1.");
    }
    for (const std::string& e : extractors) {
      for (const char* const norm : {"query_norm", "feat_norm", "ffn_norm"}) names.norm(e + norm, c);
      add_deformable(names, e + "attn.", {c, c / 2, size.deform_heads, 1});
      names.linear(e + "ffn.fc1", c / 4, c);
      names.add(e + "ffn.dwconv.dwconv.weight", {c / 4, 1, 3, 3});
      names.add(e + "ffn.dwconv.dwconv.bias", {c / 4});
      names.linear(e + "ffn.fc2", c, c / 4);
    }
  }
  names.add("up.weight", {c, c, 2, 2});
  names.add("up.bias", {c});
  for (int i = 1; i <= 4; ++i) names.batch_norm("norm" + std::to_string(i), c);
}

}  // namespace

VitSize vit_size(char letter, int64_t registers) {
  switch (letter) {
    case 's':
      return {384, 12, false, registers, 37};
    case 'b':
      return {768, 12, false, registers, 37};
    case 'l':
      return {1024, 24, false, registers, 37};
    case 'g':
      return {1536, 40, true, registers, 37};
    default:
      throw_usage(std::string("no vision transformer of size '") + letter + "'", "use s, b, l or g");
  }
}

TensorList dinov2_tensors(const VitSize& size, const std::string& prefix) {
  constexpr int64_t kPatch = 14;
  TensorNames names(prefix);
  const int64_t c = size.channels;
  names.add("cls_token", {1, 1, c});
  names.add("pos_embed", {1, 1 + size.grid * size.grid, c});
  if (size.registers > 0) names.add("register_tokens", {1, size.registers, c});
  names.add("mask_token", {1, c});
  names.convolution("patch_embed.proj", c, 3, kPatch);
  for (int64_t i = 0; i < size.depth; ++i) {
    add_block(names, "blocks." + std::to_string(i) + ".", {c, size.hidden(), size.gated});
  }
  names.norm("norm", c);
  return names.list;
}

TensorList dpt_head_tensors(const VitSize& size, int64_t features) {
  TensorNames names("decode_head.");
  const int64_t c = size.channels, f = features;
  for (int64_t j = 0; j < 4; ++j) {
    const std::string n = std::to_string(j), r = "reassemble_blocks.";
    const int64_t level = c >> (3 - j);  // C/8, C/4, C/2, C
    names.convolution(r + "projects." + n + ".conv", level, c, 1);
    constexpr int64_t kKernels[] = {4, 2, 0, 3};
    if (kKernels[j] > 0) names.convolution(r + "resize_layers." + n, level, level, kKernels[j]);
    names.linear(r + "readout_projects." + n + ".0", c, 2 * c);
    names.convolution("convs." + n + ".conv", f, level, 3, false);
    const std::string p = "fusion_blocks." + n + ".";
    names.convolution(p + "project.conv", f, f, 1);
    for (const char* const unit : {"res_conv_unit1.", "res_conv_unit2."}) {
      if (j == 0 && unit[13] == '1') continue;
      for (const char* const conv : {"conv1.conv", "conv2.conv"}) names.convolution(p + unit + conv, f, f, 3, false);
    }
  }
  constexpr int64_t kLast = 32;
  names.convolution("project.conv", f, f, 3);
  names.convolution("conv_depth.head.0", f / 2, f, 3);
  names.convolution("conv_depth.head.2", kLast, f / 2, 3);
  names.convolution("conv_depth.head.4", 1, kLast, 1);
  return names.list;
}

TensorList bn_head_tensors(int64_t inputs, int64_t classes) {
  TensorNames names("decode_head.");
  names.batch_norm("bn", inputs);
  names.convolution("conv_seg", classes, inputs, 1);
  return names.list;
}

TensorList linear_depth_tensors(int64_t inputs, int64_t bins) {
  TensorNames names("decode_head.");
  names.convolution("conv_depth", bins, inputs, 1);
  return names.list;
}

TensorList vgg16_tensors(const std::vector<int64_t>& widths) {
  TensorNames names("");
  const std::vector<std::vector<int>> stages = {{0, 2}, {5, 7}, {10, 12, 14}, {17, 19, 21}, {24, 26, 28}};
  int64_t inputs = 3;
  for (size_t s = 0; s < stages.size(); ++s) {
    for (const int index : stages[s]) {
      names.convolution("features." + std::to_string(index), widths[s], inputs, 3);
      inputs = widths[s];
    }
  }
  return names.list;
}

TensorList lpips_tensors(const std::vector<int64_t>& widths) {
  TensorNames names("");
  for (size_t s = 0; s < widths.size(); ++s)
    names.add("lin" + std::to_string(s) + ".model.1.weight", {1, widths[s], 1, 1});
  return names.list;
}

TensorList vggt_tensors(const VggtSize& size) {
  TensorNames names("");
  const int64_t c = size.encoder.channels, heads = std::max<int64_t>(c / 64, 1);
  const int64_t registers = size.encoder.registers;
  names.add("aggregator.camera_token", {1, 2, 1, c});
  names.add("aggregator.register_token", {1, 2, registers, c});
  names.append(dinov2_tensors(size.encoder, "aggregator.patch_embed."));
  for (const char* const kind : {"aggregator.frame_blocks.", "aggregator.global_blocks."}) {
    for (int64_t i = 0; i < size.depth; ++i)
      add_block(names, kind + std::to_string(i) + ".", {c, 4 * c, false, false, true, heads});
  }
  const std::string p = "camera_head.";
  constexpr int64_t kPose = 9;
  names.add(p + "empty_pose_tokens", {1, 1, kPose});
  for (int64_t i = 0; i < size.camera_depth; ++i)
    add_block(names, p + "trunk." + std::to_string(i) + ".", {2 * c, 8 * c});
  names.norm(p + "token_norm", 2 * c);
  names.norm(p + "trunk_norm", 2 * c);
  names.linear(p + "embed_pose", 2 * c, kPose);
  names.linear(p + "poseLN_modulation.1", 6 * c, 2 * c);
  names.linear(p + "pose_branch.fc1", c, 2 * c);
  names.linear(p + "pose_branch.fc2", kPose, c);
  add_dense_head(names, "point_head.", size, 4);
  add_dense_head(names, "depth_head.", size, 2);
  return names.list;
}

TensorList mask2former_tensors(const Mask2FormerSize& size) {
  TensorNames backbone("backbone.");
  const int64_t c = size.backbone.channels, f = size.features;
  backbone.add("pos_embed", {1, 1 + size.backbone.grid * size.backbone.grid, c});
  backbone.add("cls_token", {1, 1, c});
  backbone.convolution("patch_embed.proj", c, 3, 14);
  for (int64_t i = 0; i < size.backbone.depth; ++i) {
    add_block(backbone, "blocks." + std::to_string(i) + ".", {c, size.backbone.hidden(), true, true});
  }
  add_adapter(backbone, size);

  TensorNames head("decode_head.");
  const std::string d = "pixel_decoder.";
  for (int i = 0; i < 3; ++i) {
    const std::string n = d + "input_convs." + std::to_string(i);
    head.convolution(n + ".conv", f, c, 1);
    head.norm(n + ".gn", f);
  }
  for (int64_t i = 0; i < size.encoder_layers; ++i) {
    const std::string p = d + "encoder.layers." + std::to_string(i) + ".";
    add_deformable(head, p + "attentions.0.", {f, f, size.heads, 3});
    head.linear(p + "ffns.0.layers.0.0", size.ffn, f);
    head.linear(p + "ffns.0.layers.1", f, size.ffn);
    for (const char* const norm : {"norms.0", "norms.1"}) head.norm(p + norm, f);
  }
  head.add(d + "level_encoding.weight", {3, f});
  head.convolution(d + "lateral_convs.0.conv", f, c, 1, false);
  head.norm(d + "lateral_convs.0.gn", f);
  head.convolution(d + "output_convs.0.conv", f, f, 3, false);
  head.norm(d + "output_convs.0.gn", f);
  head.convolution(d + "mask_feature", f, f, 1);
  for (int64_t i = 0; i < size.decoder_layers; ++i) {
    const std::string p = "transformer_decoder.layers." + std::to_string(i) + ".";
    for (const char* const a : {"attentions.0.attn.", "attentions.1.attn."}) {
      head.add(p + a + "in_proj_weight", {3 * f, f});
      head.add(p + a + "in_proj_bias", {3 * f});
      head.linear(p + a + "out_proj", f, f);
    }
    head.linear(p + "ffns.0.layers.0.0", size.ffn, f);
    head.linear(p + "ffns.0.layers.1", f, size.ffn);
    for (const char* const norm : {"norms.0", "norms.1", "norms.2"}) head.norm(p + norm, f);
  }
  head.norm("transformer_decoder.post_norm", f);
  head.add("query_embed.weight", {size.queries, f});
  head.add("query_feat.weight", {size.queries, f});
  head.add("level_embed.weight", {3, f});
  head.linear("cls_embed", size.classes + 1, f);
  for (const char* const n : {"mask_embed.0", "mask_embed.2", "mask_embed.4"}) head.linear(n, f, f);
  backbone.append(head.list);
  return backbone.list;
}

void write_random_weights(const std::filesystem::path& path, const TensorList& tensors, uint64_t seed) {
  SafetensorsStream out(path, tensors, "F16", {{"source", "random values"}});
  Random random(seed);
  std::vector<float> values;
  for (const SafetensorsStream::Entry& tensor : tensors) {
    uint64_t left = 1;
    for (const int64_t n : tensor.shape) left *= uint64_t(n);
    const Distribution d = distribution_of(tensor.name, tensor.shape);
    while (left > 0) {
      constexpr uint64_t kBatch = uint64_t(1) << 20;  // values in memory at a time
      values.resize(size_t(std::min(left, kBatch)));
      for (float& v : values) v = float(random.uniform(d.mean - d.spread, d.mean + d.spread));
      set_fixed_values(tensor, values);
      out.append(values.data(), values.size());
      left -= values.size();
    }
  }
  out.commit();
}

}  // namespace aligngs::nn
