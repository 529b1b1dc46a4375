// Depth Anything 3's tensors.
#include "core/error.h"
#include "nn/tensor_names.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kLast = 32;  // channels before the outputs

/// A DINOv2 transformer without registers and mask token; blocks from `normed_from` on normalise queries and keys.
void add_trunk(TensorNames& names, const VitSize& size, int64_t normed_from, int64_t heads) {
  const std::string p = "backbone.pretrained.";
  const int64_t c = size.channels;
  names.add(p + "cls_token", {1, 1, c});
  names.add(p + "pos_embed", {1, 1 + size.grid * size.grid, c});
  names.convolution(p + "patch_embed.proj", c, 3, 14);
  for (int64_t i = 0; i < size.depth; ++i) {
    BlockNames block{c, size.hidden(), size.gated};
    block.head_norms = i >= normed_from;
    block.heads = heads;
    add_block(names, p + "blocks." + std::to_string(i) + ".", block);
  }
  names.norm(p + "norm", c);
}

/// The part of a head that makes a map of `outputs` channels at the size of the image.
void add_outputs(TensorNames& names, const std::string& name, int64_t inputs, int64_t outputs) {
  names.convolution(name + ".0", kLast, inputs, 3);
  names.convolution(name + ".2", outputs, kLast, 1);
}

void add_ray_branch(TensorNames& names, const Da3Size& size) {
  const int64_t f = size.features;
  add_pyramid(names, "head.", {2 * size.encoder.channels, f, size.levels, "_aux"});
  for (int level = 0; level < 4; ++level) {
    const std::string n = std::to_string(level);
    for (int i = 0; i < 5; ++i) {
      const bool narrows = i % 2 == 0;
      names.convolution("head.scratch.output_conv1_aux." + n + "." + std::to_string(i), narrows ? f / 2 : f,
                        narrows ? f : f / 2, 3);
    }
    const std::string out = "head.scratch.output_conv2_aux." + n;
    names.convolution(out + ".0", kLast, f / 2, 3);
    if (level == 0) names.norm(out + ".2", kLast);  // shared by all levels
    names.convolution(out + ".5", 7, kLast, 1);
  }
}

void add_camera_branch(TensorNames& names, const Da3Size& size) {
  const int64_t c = size.encoder.channels;
  constexpr int64_t kPose = 9;
  names.linear("cam_enc.pose_branch.fc1", c / 2, kPose);
  names.linear("cam_enc.pose_branch.fc2", c, c / 2);
  names.norm("cam_enc.token_norm", c);
  for (int64_t i = 0; i < size.camera_depth; ++i)
    add_block(names, "cam_enc.trunk." + std::to_string(i) + ".", {c, 4 * c});
  names.norm("cam_enc.trunk_norm", c);
  names.linear("cam_dec.backbone.0", 2 * c, 2 * c);
  names.linear("cam_dec.backbone.2", 2 * c, 2 * c);
  names.linear("cam_dec.fc_t", 3, 2 * c);
  names.linear("cam_dec.fc_qvec", 4, 2 * c);
  names.linear("cam_dec.fc_fov.0", 2, 2 * c);
}

}  // namespace

Da3Size da3_size(char letter) {
  switch (letter) {
    case 's':
      return {{384, 12, false, 0, 37}, 6, 4, 64, 4, {48, 96, 192, 384}};
    case 'b':
      return {};
    case 'l':
      return {{1024, 24, false, 0, 37}, 16, 8, 256, 4, {256, 512, 1024, 1024}};
    default:
      throw_usage(std::string("no any-view network of size '") + letter + "'", "use s, b or l");
  }
}

TensorList da3_tensors(const Da3Size& size) {
  TensorNames names("model.");
  add_trunk(names, size.encoder, size.alternate_from, size.heads);
  names.add("backbone.pretrained.camera_token", {1, 2, size.encoder.channels});
  const int64_t inputs = 2 * size.encoder.channels, f = size.features;
  names.norm("head.norm", inputs);
  add_pyramid(names, "head.", {inputs, f, size.levels, ""});
  names.convolution("head.scratch.output_conv1", f / 2, f, 3);
  add_outputs(names, "head.scratch.output_conv2", f / 2, 2);
  add_ray_branch(names, size);
  add_camera_branch(names, size);
  return names.list;
}

TensorList da3_metric_tensors(const Da3MetricSize& size) {
  TensorNames names("model.");
  add_trunk(names, size.encoder, size.encoder.depth, 1);
  const int64_t f = size.features;
  add_pyramid(names, "head.", {size.encoder.channels, f, size.levels, ""});
  names.convolution("head.scratch.output_conv1", f / 2, f, 3);
  add_outputs(names, "head.scratch.output_conv2", f / 2, 1);
  add_outputs(names, "head.scratch.sky_output_conv2", f / 2, 1);
  return names.list;
}

}  // namespace aligngs::nn
