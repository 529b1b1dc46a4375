#include "nn/eomt/eomt.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_integer.h"
#include "nn/network_device.h"
#include "nn/ops/activate.h"
#include "nn/ops/blocks.h"

namespace aligngs::nn {
namespace {

constexpr float kEomtNormEps = 1e-6f;
constexpr const char* kFetchAgain = "fetch the file again, or remove it";

VitOptions eomt_vit_options(int64_t heads) {
  VitOptions options;
  options.heads = heads;
  options.position = PositionRule::kPatchTable;
  options.eps = kEomtNormEps;
  return options;
}

/// A file's values for its pixels, [1, 3, 1, 1].
void load_pixel_values(const Weights& weights, const std::string& name, std::array<float, 3>& values) {
  if (!weights.has(name)) return;
  const std::vector<float> found = weights.load(name, {1, 3, 1, 1});
  std::copy(found.begin(), found.end(), values.begin());
}

Matrix part_of(const Matrix& x, int64_t first, int64_t count) {
  Matrix out(count, x.columns);
  copy_block(out.data, {}, x.data, {first * x.columns, 0}, 1, count * x.columns);
  return out;
}

}  // namespace

EomtOptions eomt_options_beside(const std::filesystem::path& weights) {
  EomtOptions options;
  const auto read = [&](const char* name, const auto& take) {
    const std::filesystem::path path = weights.parent_path() / name;
    if (!std::filesystem::exists(path)) return;
    try {
      take(nlohmann::json::parse(read_file(path)));
    } catch (const nlohmann::json::exception& error) {
      throw_bad_input(path, "", error.what(), kFetchAgain);
    }
  };
  read("config.json", [&](const nlohmann::json& config) {
    if (config.value("model_type", "") != "eomt") return;  // of another network in the same folder
    const auto count = [&](const char* key) {
      if (!config.contains(key)) return int64_t(0);
      const std::optional<int64_t> value = integer_in<int64_t>(config.at(key));
      if (!value || *value < 0) throw_bad_input(weights.parent_path() / "config.json", key, "not a count", kFetchAgain);
      return *value;
    };
    options.heads = count("num_attention_heads");
    options.query_blocks = count("num_blocks");
  });
  read("preprocessor_config.json", [&](const nlohmann::json& config) {
    if (config.contains("image_mean")) config.at("image_mean").get_to(options.mean);
    if (config.contains("image_std")) config.at("image_std").get_to(options.deviation);
  });
  return options;
}

Eomt::Eomt(Compute& compute, const Weights& weights, const EomtOptions& options) : options_(options) {
  ComputeOptions exact = compute.options();
  exact.precision = Precision::kFloat32;
  exact_ = std::make_unique<Compute>(compute.pool(), exact);
  vit_ = std::make_unique<Vit>(compute, weights.sub("encoder.backbone."), eomt_vit_options(options.heads));
  const int64_t c = vit_->channels();
  const Shape table = weights.shape("encoder.backbone.pos_embed");
  window_ = int(std::lround(std::sqrt(double(table[table.size() - 2]))) * vit_->patch());
  load_pixel_values(weights, "encoder.pixel_mean", options_.mean);
  load_pixel_values(weights, "encoder.pixel_std", options_.deviation);
  for (const float deviation : options_.deviation) {
    if (!(deviation > 0)) {
      throw Error({ErrorKind::kWeights,
                   "a standard deviation of pixels is not positive",
                   {},
                   "encoder.pixel_std",
                   "these are not the weights of this network, or they are damaged"});
    }
  }
  if (options_.query_blocks <= 0) options_.query_blocks = weights.dimension("attn_mask_probs", 0);
  check_masks(weights);
  queries_ = Matrix(weights.dimension("q.weight", 0), c);
  queries_.data = weights.load("q.weight", {queries_.rows, c});
  class_head_ = Linear(*exact_, weights, "class_head", weights.dimension("class_head.weight", 0), c);
  mask_head1_ = Linear(*exact_, weights, "mask_head.0", c, c);
  mask_head2_ = Linear(*exact_, weights, "mask_head.2", c, c);
  mask_head3_ = Linear(*exact_, weights, "mask_head.4", c, c);
  for (int i = 0; i < weights.count("upscale."); ++i) {
    const std::string n = "upscale." + std::to_string(i) + ".";
    upscale_.push_back(
        {TransposedConvolution(compute, weights, n + "conv1", c, c, 2),
         DepthwiseConvolution(weights.load(n + "conv2.weight", {c, 1, 3, 3}), std::vector<float>(size_t(c))),
         LayerNorm(weights, n + "norm", c, kEomtNormEps)});
  }
}

void Eomt::check_masks(const Weights& weights) const {
  if (options_.query_blocks < 1 || options_.query_blocks > vit_->depth()) {
    throw Error(
        {ErrorKind::kWeights,
         std::to_string(options_.query_blocks) + " of " + std::to_string(vit_->depth()) + " blocks hold queries",
         {},
         "attn_mask_probs",
         "these are not the weights of this network"});
  }
  if (!weights.has("attn_mask_probs")) return;
  for (const float share : weights.load("attn_mask_probs", {weights.dimension("attn_mask_probs", 0)})) {
    if (share > 0) {
      throw Error({ErrorKind::kWeights,
                   "attention masks of training are still in use, which makes the result random",
                   {},
                   "attn_mask_probs",
                   "use weights of the end of the training"});
    }
  }
}

FeatureMap Eomt::upscale(Compute& compute, const Upscale& step, const FeatureMap& x) const {
  FeatureMap grown = step.grow(compute, x);
  activate(compute, grown, Activation::kGelu);
  FeatureMap mixed(grown.height, grown.width, grown.channels);
  if (NetworkDevice* const device = compute.device()) {
    step.mix.apply_on(*device, grown.data.on(*device), grown.height, grown.width, mixed.data.write_on(*device));
  } else {
    step.mix.apply(compute, grown.data.data(), grown.height, grown.width, mixed.data.data());
  }
  return FeatureMap(grown.height, grown.width, step.norm(compute, std::move(mixed).take_rows()));
}

EomtPrediction Eomt::operator()(Compute& compute, const Image<uint8_t>& window, EomtInside* inside) const {
  if (window.channels != 3) throw_bad_input({}, "window", "it is not RGB");
  FeatureMap input(window.height, window.width, 3);
  for (size_t i = 0; i < input.data.size(); ++i)
    input.data[i] = (float(window.data[i]) / 255.0f - options_.mean[i % 3]) / options_.deviation[i % 3];
  VitTokens embedded = vit_->embed(compute, {std::move(input)});
  Matrix x = std::move(embedded.tokens);
  const int64_t c = x.columns, first_with_queries = vit_->depth() - options_.query_blocks;
  for (int64_t i = 0; i < vit_->depth(); ++i) {
    if (i == first_with_queries) {
      if (inside) inside->tokens_before = x;
      Matrix joined(queries_.rows + x.rows, c);
      copy_block(joined.data, {queries_.rows * c, 0}, x.data, {}, 1, x.rows * c);
      copy_block(joined.data, {}, queries_.data, {}, 1, queries_.rows * c);
      x = std::move(joined);
    }
    vit_->blocks()[size_t(i)].forward(compute, x, 1);
  }
  if (inside) inside->tokens_last = x;
  const Matrix normed = vit_->normed(compute, x);
  const Matrix queries = part_of(normed, 0, queries_.rows);
  EomtPrediction out;
  out.classes = class_head_(*exact_, queries);
  const Matrix embedding =
      mask_head3_(*exact_, mask_head2_(*exact_, mask_head1_(*exact_, queries, Activation::kGelu), Activation::kGelu));
  const int64_t patches = embedded.grid_height * embedded.grid_width;
  FeatureMap map(embedded.grid_height, embedded.grid_width, part_of(normed, normed.rows - patches, patches));
  for (const Upscale& step : upscale_) map = upscale(compute, step, map);
  out.masks = Linear(*exact_, embedding.data, embedding.rows, c, {})(*exact_, map);
  if (inside) {
    inside->mask_embedding = embedding;
    inside->upscaled = std::move(map);
  }
  return out;
}

}  // namespace aligngs::nn
