#include "nn/bn_head.h"

#include <algorithm>

#include "core/error.h"
#include "nn/ops/blocks.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {

BnHeadNetwork::BnHeadNetwork(const Compute& compute, const Weights& backbone, const Weights& head,
                             const BnHeadOptions& options)
    : vit_(compute, backbone, options.vit) {
  const Weights weights = head.sub("decode_head.");
  const int64_t inputs = weights.dimension("conv_seg.weight", 1);
  const int64_t outputs = weights.dimension("conv_seg.weight", 0);
  std::vector<int> layers = options.layers;
  if (layers.empty()) {
    for (int i = 4; i >= 1; --i) layers.push_back(int(vit_.depth()) - i);
  }
  std::vector<int> index = options.in_index;
  if (index.empty()) {
    const int64_t count = inputs / vit_.channels();
    for (int64_t i = int64_t(layers.size()) - count; i < int64_t(layers.size()); ++i) index.push_back(int(i));
  }
  for (const int i : index) {
    if (i < 0 || i >= int(layers.size())) {
      throw Error(
          {ErrorKind::kWeights,
           std::to_string(inputs) + " inputs do not fit a backbone of " + std::to_string(vit_.channels()) + " channels",
           {},
           "decode_head.conv_seg.weight",
           "use the head that belongs to this backbone"});
    }
    layers_.push_back(layers[size_t(i)]);
  }
  if (inputs != vit_.channels() * int64_t(layers_.size())) {
    throw Error({ErrorKind::kWeights,
                 "shape (" + std::to_string(outputs) + ", " +
                     std::to_string(vit_.channels() * int64_t(layers_.size())) +
                     ", 1, 1) expected for this backbone, " + std::to_string(inputs) + " inputs found",
                 {},
                 "decode_head.conv_seg.weight",
                 "use the head that belongs to this backbone"});
  }
  const BatchNorm norm(weights, "bn", inputs);
  std::vector<float> weight = weights.load("conv_seg.weight", {outputs, inputs, 1, 1});
  std::vector<float> bias = weights.load("conv_seg.bias", {outputs});
  for (size_t o = 0; o < size_t(outputs); ++o) {
    double shift = 0;
    for (size_t i = 0; i < size_t(inputs); ++i) {
      shift += double(weight[o * size_t(inputs) + i]) * double(norm.shift[i]);
      weight[o * size_t(inputs) + i] *= norm.scale[i];
    }
    bias[o] += float(shift);
  }
  classify_ = Linear(compute, weight, outputs, inputs, std::move(bias));
}

FeatureMap BnHeadNetwork::grid_logits(Compute& compute, const FeatureMap& image) const {
  const VitTokens tokens = vit_(compute, {centre_padded(image, vit_.patch())}, layers_);
  const int64_t c = vit_.channels();
  FeatureMap joined(tokens.grid_height, tokens.grid_width, c * int64_t(layers_.size()));
  for (size_t k = 0; k < layers_.size(); ++k) {
    const FeatureMap map = tokens.patches(vit_.normed(compute, tokens.blocks[k]));
    copy_block(joined.data, {int64_t(k) * c, joined.channels}, map.data, {0, c}, map.places(), c);
  }
  return classify_(compute, joined);
}

FeatureMap BnHeadNetwork::predict(Compute& compute, const FeatureMap& window) const {
  // The map of the padded window is stretched to the window, as published.
  return resize_bilinear_map(compute, grid_logits(compute, window), window.height, window.width, false);
}

}  // namespace aligngs::nn
