#include "nn/mask2former.h"

#include <algorithm>
#include <cmath>

#include "nn/ops/blocks.h"
#include "nn/ops/position_encoding.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

constexpr float kMaskFormerNormEps = 1e-5f;

Matrix sum(const Matrix& a, const Matrix& b) {
  Matrix out = a;
  add_values(out.data, b.data);
  return out;
}

/// x = norm(x + update).
void add_and_norm(Compute& compute, Matrix& x, const Matrix& update, const LayerNorm& norm) {
  x = norm(compute, sum(x, update));
}

}  // namespace

Mask2Former::Mask2Former(Compute& compute, const Weights& weights, const Mask2FormerOptions& options)
    : backbone_(compute, weights.sub("backbone."), options.adapter) {
  ComputeOptions exact = compute.options();
  exact.precision = Precision::kFloat32;
  exact_ = std::make_unique<Compute>(compute.pool(), exact);
  const Weights head = weights.sub("decode_head.");
  pixel_decoder_ = std::make_unique<PixelDecoder>(compute, head.sub("pixel_decoder."),
                                                  PixelDecoder::Options{options.groups, options.heads});
  const int64_t heads = options.heads > 0 ? options.heads : pixel_decoder_->heads();
  const int64_t f = pixel_decoder_->features();
  const int64_t queries = head.dimension("query_feat.weight", 0);
  query_feat_ = query_embed_ = Matrix(queries, f);
  query_feat_.data = head.load("query_feat.weight", {queries, f});
  query_embed_.data = head.load("query_embed.weight", {queries, f});
  level_embed_ = head.load("level_embed.weight", {3, f});
  const Weights decoder = head.sub("transformer_decoder.");
  const int depth = decoder.count("layers.");
  for (int i = 0; i < depth; ++i) {
    const Weights w = decoder.sub("layers." + std::to_string(i) + ".");
    const int64_t hidden = w.dimension("ffns.0.layers.0.0.weight", 0);
    layers_.push_back({MultiheadAttention(*exact_, w.sub("attentions.0.attn."), f, heads),
                       MultiheadAttention(*exact_, w.sub("attentions.1.attn."), f, heads),
                       LayerNorm(w, "norms.0", f, kMaskFormerNormEps), LayerNorm(w, "norms.1", f, kMaskFormerNormEps),
                       LayerNorm(w, "norms.2", f, kMaskFormerNormEps),
                       Linear(*exact_, w, "ffns.0.layers.0.0", hidden, f),
                       Linear(*exact_, w, "ffns.0.layers.1", f, hidden)});
  }
  post_norm_ = LayerNorm(decoder, "post_norm", f, kMaskFormerNormEps);
  class_embed_ = Linear(*exact_, head, "cls_embed", head.dimension("cls_embed.weight", 0), f);
  mask_embed1_ = Linear(*exact_, head, "mask_embed.0", f, f);
  mask_embed2_ = Linear(*exact_, head, "mask_embed.2", f, f);
  mask_embed3_ = Linear(*exact_, head, "mask_embed.4", f, f);
}

Matrix Mask2Former::mask_embedding(Compute& compute, const Matrix& normed) const {
  return mask_embed3_(compute,
                      mask_embed2_(compute, mask_embed1_(compute, normed, Activation::kRelu), Activation::kRelu));
}

FeatureMap Mask2Former::mask_logits(const Matrix& embedding, const FeatureMap& features) const {
  const Linear product(*exact_, embedding.data, embedding.rows, embedding.columns, {});
  return product(*exact_, features);
}

Mask2Former::Prediction Mask2Former::decode(Compute& compute, const PixelDecoder::Output& pixels,
                                            const DecodingHooks& hooks) const {
  const int64_t f = pixel_decoder_->features(), queries = query_feat_.rows;
  std::array<Matrix, 3> keys, values;
  std::array<FeatureMap, 3> level_features;
  for (size_t i = 0; i < 3; ++i) {
    const FeatureMap& memory = pixels.memories[i];
    values[i] = FeatureMap(memory).take_rows();
    for (int64_t p = 0; p < values[i].rows; ++p) {
      for (int64_t k = 0; k < f; ++k) values[i].row(p)[k] += level_embed_[i * size_t(f) + size_t(k)];
    }
    keys[i] = sum(values[i], sine_encoding(memory.height, memory.width, f / 2).take_rows());
    // Mask logits are a product with these features, which commutes with resizing them.
    level_features[i] = resize_bilinear_map(compute, pixels.mask_features, memory.height, memory.width, false);
  }
  Matrix q = query_feat_;
  const auto predict = [&](const Matrix& normed) {
    return Prediction{class_embed_(*exact_, normed),
                      mask_logits(mask_embedding(*exact_, normed), pixels.mask_features)};
  };
  Matrix normed = post_norm_(compute, q);
  if (hooks.visit) hooks.visit(0, predict(normed));
  for (size_t l = 0; l < layers_.size(); ++l) {
    const Layer& layer = layers_[l];
    const size_t level = l % 3;
    const int64_t places = keys[level].rows;
    const FeatureMap logits = hooks.masks
                                  ? resize_bilinear_map(compute, hooks.masks(int(l)), level_features[level].height,
                                                        level_features[level].width, false)
                                  : mask_logits(mask_embedding(*exact_, normed), level_features[level]);
    // Masked where sigmoid(logit) < 0.5; a query that would see nothing sees everything.
    std::vector<uint8_t> masked(size_t(queries * places));
    for (int64_t i = 0; i < queries; ++i) {
      uint8_t* row = masked.data() + i * places;
      for (int64_t p = 0; p < places; ++p) row[p] = logits.data[size_t(p * queries + i)] < 0;
      if (std::find(row, row + places, uint8_t(0)) == row + places) std::fill_n(row, places, uint8_t(0));
    }
    add_and_norm(compute, q, layer.cross(*exact_, sum(q, query_embed_), keys[level], values[level], 1, masked.data()),
                 layer.norm1);
    const Matrix placed = sum(q, query_embed_);
    add_and_norm(compute, q, layer.self(*exact_, placed, placed, q), layer.norm2);
    add_and_norm(compute, q, layer.fc2(*exact_, layer.fc1(*exact_, q, Activation::kRelu)), layer.norm3);
    normed = post_norm_(compute, q);
    if (hooks.visit) hooks.visit(int(l) + 1, predict(normed));
  }
  return predict(normed);
}

FeatureMap Mask2Former::scores_of(const Prediction& prediction) const {
  Matrix shares = prediction.classes;
  softmax_rows(shares.data.data(), shares.rows, shares.columns);
  const int64_t queries = shares.rows, count = classes();
  std::vector<float> weight(size_t(count * queries));  // without the last class, "no object"
  for (int64_t q = 0; q < queries; ++q) {
    for (int64_t k = 0; k < count; ++k) weight[size_t(k * queries + q)] = shares.row(q)[k];
  }
  FeatureMap covered = prediction.masks;
  for (float& v : covered.data) v = 1 / (1 + std::exp(-v));
  return Linear(*exact_, weight, count, queries, {})(*exact_, covered);
}

FeatureMap Mask2Former::quarter_scores(Compute& compute, const FeatureMap& window) const {
  return scores_of(decode(compute, (*pixel_decoder_)(compute, backbone_(compute, window))));
}

FeatureMap Mask2Former::predict(Compute& compute, const FeatureMap& window) const {
  constexpr int64_t kMultiple = 32;
  const auto up = [](int64_t n) { return (n + kMultiple - 1) / kMultiple * kMultiple; };
  const int64_t height = up(window.height), width = up(window.width);
  const bool fits = height == window.height && width == window.width;
  return resize_bilinear_map(
      compute, quarter_scores(compute, fits ? window : resize_bilinear_map(compute, window, height, width, false)),
      window.height, window.width, false);
}

}  // namespace aligngs::nn
