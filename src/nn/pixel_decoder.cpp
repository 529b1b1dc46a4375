#include "nn/pixel_decoder.h"

#include <algorithm>

#include "nn/dpt_parts.h"
#include "nn/ops/blocks.h"
#include "nn/ops/position_encoding.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

constexpr float kPixelDecoderNormEps = 1e-5f;

}  // namespace

PixelDecoder::PixelDecoder(const Compute& compute, const Weights& weights, const Options& options) {
  features_ = weights.dimension("level_encoding.weight", 1);
  const int64_t f = features_;
  // The input and output projections are exact, and are a small part of the work. Their rounding
  // would go straight into the mask logits, whose sign decides the attention of queries.
  for (size_t i = 0; i < 3; ++i) {
    const std::string n = "input_convs." + std::to_string(i);
    inputs_[i] = Linear(compute, weights, n + ".conv", f, weights.dimension(n + ".conv.weight", 1), true);
    input_norms_[i] = GroupNorm(weights, n + ".gn", f, options.groups);
  }
  level_encoding_ = weights.load("level_encoding.weight", {3, f});
  const int depth = weights.count("encoder.layers.");
  if (depth == 0) weights.shape("encoder.layers.0.norms.0.weight");  // throws: missing
  for (int i = 0; i < depth; ++i) {
    const Weights w = weights.sub("encoder.layers." + std::to_string(i) + ".");
    const int64_t hidden = w.dimension("ffns.0.layers.0.0.weight", 0);
    layers_.push_back(
        {DeformableAttention(compute, w.sub("attentions.0."), 3, options.heads),
         LayerNorm(w, "norms.0", f, kPixelDecoderNormEps), LayerNorm(w, "norms.1", f, kPixelDecoderNormEps),
         Linear(compute, w, "ffns.0.layers.0.0", hidden, f), Linear(compute, w, "ffns.0.layers.1", f, hidden)});
  }
  lateral_ =
      Linear(compute, weights, "lateral_convs.0.conv", f, weights.dimension("lateral_convs.0.conv.weight", 1), true);
  lateral_norm_ = GroupNorm(weights, "lateral_convs.0.gn", f, options.groups);
  output_ = Convolution(compute, weights, "output_convs.0.conv", {f, f, 3, 1, 1});
  output_norm_ = GroupNorm(weights, "output_convs.0.gn", f, options.groups);
  mask_feature_ = Linear(compute, weights, "mask_feature", f, f, true);
}

PixelDecoder::Output PixelDecoder::operator()(Compute& compute, const std::array<FeatureMap, 4>& maps) const {
  const int64_t f = features_;
  std::vector<MapSize> sizes;
  int64_t places = 0;
  for (size_t i = 0; i < 3; ++i) {
    sizes.push_back({maps[3 - i].height, maps[3 - i].width});
    places += sizes.back().places();
  }
  Matrix x(places, f), position(places, f), reference(places, 2);
  int64_t first = 0;
  for (size_t i = 0; i < 3; ++i) {
    FeatureMap level = inputs_[i](compute, maps[3 - i]);
    input_norms_[i].apply(compute, level);
    copy_block(x.data, {first * f, 0}, level.data, {}, 1, level.places() * f);
    const FeatureMap sine = sine_encoding(level.height, level.width, f / 2);
    const Matrix points = reference_points(level.height, level.width);
    std::copy(points.data.begin(), points.data.end(), reference.row(first));
    const float* from = sine.data.data();
    float* to = position.row(first);
    for (int64_t p = 0; p < level.places(); ++p) {
      for (int64_t k = 0; k < f; ++k) *to++ = *from++ + level_encoding_[i * size_t(f) + size_t(k)];
    }
    first += level.places();
  }
  for (const Layer& layer : layers_) {
    Matrix query = x;
    add_values(query.data, position.data);
    const Matrix update = layer.attention(compute, query, reference, x, sizes);
    if (compute.device()) {
      add_values(x.data, update.data);
      x = layer.norm1(compute, x);
      add_values(x.data, layer.fc2(compute, layer.fc1(compute, x, Activation::kRelu)).data);
      x = layer.norm2(compute, x);
      continue;
    }
    compute.for_rows(places, 0, [&](int64_t begin, int64_t count, Scratch& scratch) {
      float* rows = x.row(begin);
      float* hidden = scratch.floats(size_t(count * layer.fc1.outputs()));
      float* change = scratch.floats(size_t(count * f));
      add_scaled(rows, update.row(begin), count, f, nullptr, nullptr);
      layer.norm1.rows(rows, count, rows);
      layer.fc1.rows(rows, count, hidden, scratch, Activation::kRelu);
      layer.fc2.product(hidden, count, change, scratch);
      add_scaled(rows, change, count, f, layer.fc2.bias(), nullptr);
      layer.norm2.rows(rows, count, rows);
    });
  }
  Output out;
  first = 0;
  for (size_t i = 0; i < 3; ++i) {
    out.memories[i] = FeatureMap(sizes[i].height, sizes[i].width, f);
    copy_block(out.memories[i].data, {}, x.data, {first * f, 0}, 1, sizes[i].places() * f);
    first += sizes[i].places();
  }
  FeatureMap fine = lateral_(compute, maps[0]);
  lateral_norm_.apply(compute, fine);
  add_map(fine, resize_bilinear_map(compute, out.memories[2], fine.height, fine.width, false));
  fine = output_(compute, fine);
  output_norm_.apply(compute, fine, true);
  out.mask_features = mask_feature_(compute, fine);
  return out;
}

}  // namespace aligngs::nn
