#include "nn/transformer_block.h"

#include <algorithm>

#include "core/error.h"
#include "nn/attention.h"
#include "nn/network_device.h"

namespace aligngs::nn {
namespace {

constexpr float kBlockHeadNormEps = 1e-5f;  // of q_norm and k_norm, in VGGT and DA3

std::vector<float> layer_scale(const Weights& weights, const char* name, const char* other, int64_t channels) {
  if (weights.has(name)) return weights.load(name, {channels});
  if (weights.has(other)) return weights.load(other, {channels});
  return {};
}

/// Rows of queries and keys [2 * heads * dim, ...] of `size` values each. Quarters 0 1 2 3 of every head become 0 2 1
/// 3: pairs (i, i + dim / 2) become Rope2d's.
void pair_within_axes(std::vector<float>& values, int64_t heads, int64_t dim, int64_t size) {
  const int64_t quarter = dim / 4 * size;
  for (int64_t h = 0; h < 2 * heads; ++h) {
    const auto first = values.begin() + h * dim * size;
    std::swap_ranges(first + quarter, first + 2 * quarter, first + 2 * quarter);
  }
}

Linear load_qkv(const Compute& compute, const Weights& weights, const TransformerBlock::Config& config) {
  const std::string name = "attn.qkv", mask_name = name + ".bias_mask";
  const int64_t c = config.channels;
  if (!config.halves_paired && !weights.has(mask_name)) return Linear(compute, weights, name, 3 * c, c);
  std::vector<float> weight = weights.load(name + ".weight", {3 * c, c}), bias;
  if (weights.has(name + ".bias")) bias = weights.load(name + ".bias", {3 * c});
  if (weights.has(mask_name) && !bias.empty()) {
    const std::vector<float> mask = weights.load(mask_name, {3 * c});
    for (size_t i = 0; i < bias.size(); ++i) bias[i] *= mask[i];
  }
  if (config.halves_paired) {
    if (c / config.heads % 4 != 0 || weights.has("attn.q_norm.weight")) {
      throw Error({ErrorKind::kWeights,
                   "heads of " + std::to_string(c / config.heads) +
                       " channels, or with norms of their own, cannot be turned in pairs of halves",
                   {},
                   name,
                   "these are not the weights of this network"});
    }
    pair_within_axes(weight, config.heads, c / config.heads, c);
    if (!bias.empty()) pair_within_axes(bias, config.heads, c / config.heads, 1);
  }
  return Linear(compute, weight, 3 * c, c, std::move(bias));
}

const float* or_null(const Values& values) { return values.empty() ? nullptr : values.data(); }

}  // namespace

TransformerBlock::TransformerBlock(const Compute& compute, const Weights& weights, const Config& config)
    : config_(config) {
  const int64_t c = config.channels;
  if (config.heads <= 0 || c % config.heads != 0) {
    throw Error({ErrorKind::kWeights,
                 std::to_string(c) + " channels do not divide into " + std::to_string(config.heads) + " heads",
                 {},
                 "attn",
                 "set the number of heads"});
  }
  norm1_ = LayerNorm(weights, "norm1", c, config.eps);
  norm2_ = LayerNorm(weights, "norm2", c, config.eps);
  qkv_ = load_qkv(compute, weights, config);
  proj_ = Linear(compute, weights, "attn.proj", c, c);
  if (weights.has("attn.q_norm.weight")) {
    q_norm_ = LayerNorm(weights, "attn.q_norm", c / config.heads, kBlockHeadNormEps);
    k_norm_ = LayerNorm(weights, "attn.k_norm", c / config.heads, kBlockHeadNormEps);
  }
  scale1_ = layer_scale(weights, "ls1.gamma", "gamma1", c);
  scale2_ = layer_scale(weights, "ls2.gamma", "gamma2", c);
  gated_ = weights.has("mlp.w3.weight");
  if (!gated_) {
    const int64_t hidden = weights.dimension("mlp.fc1.weight", 0);
    fc1_ = Linear(compute, weights, "mlp.fc1", hidden, c);
    fc2_ = Linear(compute, weights, "mlp.fc2", c, hidden);
    return;
  }
  const int64_t hidden = weights.dimension("mlp.w3.weight", 1);
  fc2_ = Linear(compute, weights, "mlp.w3", c, hidden);
  if (weights.has("mlp.w12.weight")) {
    fc1_ = Linear(compute, weights, "mlp.w12", 2 * hidden, c);
    return;
  }
  std::vector<float> weight = weights.load("mlp.w1.weight", {hidden, c});
  const std::vector<float> more = weights.load("mlp.w2.weight", {hidden, c});
  weight.insert(weight.end(), more.begin(), more.end());
  std::vector<float> bias;
  if (weights.has("mlp.w1.bias")) {
    bias = weights.load("mlp.w1.bias", {hidden});
    const std::vector<float> more_bias = weights.load("mlp.w2.bias", {hidden});
    bias.insert(bias.end(), more_bias.begin(), more_bias.end());
  }
  fc1_ = Linear(compute, weight, 2 * hidden, c, std::move(bias));
}

void TransformerBlock::attend(Compute& compute, const Matrix& x, int64_t sequences, const TokenPlaces* places,
                              Matrix& out) const {
  const int64_t c = config_.channels, tokens = x.rows / sequences, dim = c / config_.heads;
  AttentionOperands operands(compute, {sequences, config_.heads, dim, tokens, tokens});
  compute.for_rows(x.rows, 0, [&](int64_t begin, int64_t count, Scratch& scratch) {
    float* normed = scratch.floats(size_t(count * c));
    float* qkv = scratch.floats(size_t(count * 3 * c));
    norm1_.rows(x.row(begin), count, normed);
    qkv_.rows(normed, count, qkv, scratch);
    for (int64_t i = 0; i < count; ++i) {
      float* row = qkv + i * 3 * c;
      const int64_t sequence = (begin + i) / tokens, token = (begin + i) % tokens;
      if (q_norm_.channels() > 0) {
        q_norm_.rows(row, config_.heads, row);
        k_norm_.rows(row + c, config_.heads, row + c);
      }
      if (places) {
        const TokenPlaces::Place at = places->places[size_t(token) % places->places.size()];
        for (int64_t h = 0; h < 2 * config_.heads; ++h)  // queries, then keys
          places->rope.rotate(row + h * dim, at.y, at.x);
      }
      operands.set_query_row(sequence, token, row);
      operands.set_key_row(sequence, token, row + c);
      operands.set_value_row(sequence, token, row + 2 * c);
    }
  });
  attention(compute, operands, out.data.data());
}

void TransformerBlock::forward_on(NetworkDevice& device, Compute& compute, Matrix& x, int64_t sequences,
                                  const TokenPlaces* places) const {
  const int64_t c = config_.channels, tokens = x.rows / sequences, dim = c / config_.heads;
  const auto add = [&](const Linear& linear, const Matrix& from, const Values& scale) {
    const Matrix update = linear.product_on(device, from);
    device.add_scaled(x.data.change_on(device), update.data.on(device), x.rows, c, linear.bias_values().on(device),
                      scale.on(device));
  };
  Matrix qkv = qkv_(compute, norm1_(compute, x));
  HeadPreparation heads{x.rows, config_.heads, dim};
  std::vector<int> at;
  if (q_norm_.channels() > 0) {
    heads.q_weight = q_norm_.weight().on(device);
    heads.q_bias = q_norm_.bias().on(device);
    heads.k_weight = k_norm_.weight().on(device);
    heads.k_bias = k_norm_.bias().on(device);
    heads.eps = q_norm_.eps();
  }
  if (places) {
    // Every sequence begins at the first place again.
    for (int64_t t = 0; t < tokens; ++t) {
      const TokenPlaces::Place place = places->places[size_t(t) % places->places.size()];
      at.push_back(place.y);
      at.push_back(place.x);
    }
    heads.cosines = places->rope.cosines().on(device);
    heads.sines = places->rope.sines().on(device);
    heads.places = &at;
  }
  device.prepare_heads(heads, qkv.data.change_on(device));
  Matrix attended(x.rows, c);
  const float* const rows = qkv.data.on(device);
  device.attention({sequences, config_.heads, dim, tokens, tokens}, {rows, 3 * c}, {rows + c, 3 * c},
                   {rows + 2 * c, 3 * c}, nullptr, compute.precision(), attended.data.write_on(device));
  add(proj_, attended, scale1_);
  const Matrix normed = norm2_(compute, x);
  if (!gated_) {
    add(fc2_, fc1_(compute, normed, Activation::kGelu), scale2_);
    return;
  }
  const Matrix wide = fc1_(compute, normed);
  Matrix gated(x.rows, fc2_.inputs());
  device.swiglu(wide.data.on(device), x.rows, gated.columns, gated.data.write_on(device));
  add(fc2_, gated, scale2_);
}

void TransformerBlock::forward(Compute& compute, Matrix& x, int64_t sequences, const TokenPlaces* places) const {
  if (NetworkDevice* const device = compute.device()) {
    forward_on(*device, compute, x, sequences, places);
    return;
  }
  const int64_t c = config_.channels, hidden = fc2_.inputs();
  Matrix attended(x.rows, c);
  attend(compute, x, sequences, places, attended);
  compute.for_rows(x.rows, 0, [&](int64_t begin, int64_t count, Scratch& scratch) {
    float* update = scratch.floats(size_t(count * c));
    float* wide = scratch.floats(size_t(count * fc1_.outputs()));
    proj_.product(attended.row(begin), count, update, scratch);
    add_scaled(x.row(begin), update, count, c, proj_.bias(), or_null(scale1_));
    norm2_.rows(x.row(begin), count, update);
    if (gated_) {
      float* gated = scratch.floats(size_t(count * hidden));
      fc1_.rows(update, count, wide, scratch);
      swiglu(wide, count, hidden, gated);
      fc2_.product(gated, count, update, scratch);
    } else {
      fc1_.rows(update, count, wide, scratch, Activation::kGelu);
      fc2_.product(wide, count, update, scratch);
    }
    add_scaled(x.row(begin), update, count, c, fc2_.bias(), or_null(scale2_));
  });
}

}  // namespace aligngs::nn
