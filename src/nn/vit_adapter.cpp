#include "nn/vit_adapter.h"

#include <algorithm>

#include "core/error.h"
#include "nn/dpt_parts.h"
#include "nn/network_device.h"
#include "nn/ops/blocks.h"
#include "nn/ops/position_encoding.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

constexpr float kAdapterNormEps = 1e-6f;
constexpr int64_t kMultiple = 32;  // of the sides, so that all scales divide

VitOptions adapted(VitOptions options) {
  options.position = PositionRule::kPlain;
  options.eps = kAdapterNormEps;
  options.patches_cut = true;  // 32 is no multiple of 14
  return options;
}

/// A 3x3 convolution without bias whose batch norm is folded in.
Convolution normed_convolution(const Compute& compute, const Weights& weights, const std::string& convolution,
                               const std::string& norm, int64_t stride) {
  const int64_t outputs = weights.dimension(convolution + ".weight", 0);
  const BatchNorm folded(weights, norm, outputs);
  return Convolution(compute, weights, convolution,
                     {outputs, weights.dimension(convolution + ".weight", 1), 3, stride, 1, true}, &folded);
}

Matrix rows_below(const Matrix& above, const Matrix& below) {
  Matrix out(above.rows + below.rows, above.columns);
  const auto size = [](const Matrix& m) { return m.rows * m.columns; };
  copy_block(out.data, {}, above.data, {}, 1, size(above));
  copy_block(out.data, {size(above), 0}, below.data, {}, 1, size(below));
  return out;
}

Matrix rows_of(const Matrix& m, int64_t first, int64_t count) {
  Matrix out(count, m.columns);
  copy_block(out.data, {}, m.data, {first * m.columns, 0}, 1, count * m.columns);
  return out;
}

}  // namespace

VitAdapter::VitAdapter(const Compute& compute, const Weights& weights, const AdapterOptions& options)
    : vit_(compute, weights, adapted(options.vit)) {
  const int64_t c = channels();
  for (size_t i = 0; i < 3; ++i) {
    const std::string conv = "spm.stem." + std::to_string(3 * i);
    const std::string norm = "spm.stem." + std::to_string(3 * i + 1);
    stem_[i] = normed_convolution(compute, weights, conv, norm, i == 0 ? 2 : 1);
    const std::string down = "spm.conv" + std::to_string(i + 2);
    down_[i] = normed_convolution(compute, weights, down + ".0", down + ".1", 2);
  }
  for (size_t i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i + 1);
    widen_[i] = Linear(compute, weights, "spm.fc" + n, c,
                       i == 0 ? stem_[2].shape().outputs : down_[i - 1].shape().outputs, true);
    norms_[i] = BatchNorm(weights, "norm" + n, c);
  }
  level_embed_ = weights.load("level_embed", {3, c});
  up_ = TransposedConvolution(compute, weights, "up", c, c, 2);
  const int count = weights.count("interactions.");
  if (count == 0) weights.shape("interactions.0.injector.gamma");  // throws: missing
  for (int i = 0; i < count; ++i) {
    const Weights w = weights.sub("interactions." + std::to_string(i) + ".");
    Interaction interaction;
    const Weights injector = w.sub("injector.");
    interaction.injector = {
        LayerNorm(injector, "query_norm", c, kAdapterNormEps), LayerNorm(injector, "feat_norm", c, kAdapterNormEps),
        DeformableAttention(compute, injector.sub("attn."), 3, options.deformable_heads), injector.load("gamma", {c})};
    const auto extractor = [&](const std::string& name) {
      interaction.extractors.push_back(make_extractor(compute, w.sub(name), options.deformable_heads));
    };
    extractor("extractor.");
    for (int e = 0; e < w.count("extra_extractors."); ++e) extractor("extra_extractors." + std::to_string(e) + ".");
    const int depth = int(vit_.depth());
    interaction.first_block = options.blocks.empty() ? i * depth / count : options.blocks.at(size_t(i))[0];
    interaction.last_block = options.blocks.empty() ? (i + 1) * depth / count - 1 : options.blocks.at(size_t(i))[1];
    if (interaction.first_block < 0 || interaction.last_block >= depth)
      throw_usage("an interaction names a block that the backbone lacks", "correct the list of blocks");
    interactions_.push_back(std::move(interaction));
  }
}

VitAdapter::Extractor VitAdapter::make_extractor(const Compute& compute, const Weights& weights,
                                                 int64_t deformable_heads) const {
  const int64_t c = channels(), hidden = weights.dimension("ffn.fc1.weight", 0);
  return {LayerNorm(weights, "query_norm", c, kAdapterNormEps),
          LayerNorm(weights, "feat_norm", c, kAdapterNormEps),
          LayerNorm(weights, "ffn_norm", c, kAdapterNormEps),
          DeformableAttention(compute, weights.sub("attn."), 1, deformable_heads),
          Linear(compute, weights, "ffn.fc1", hidden, c),
          Linear(compute, weights, "ffn.fc2", c, hidden),
          DepthwiseConvolution(weights, "ffn.dwconv.dwconv", hidden)};
}

std::array<FeatureMap, 4> VitAdapter::spatial_prior(Compute& compute, const FeatureMap& image) const {
  const Convolution::Options relu{false, Activation::kRelu};
  FeatureMap x = stem_[0](compute, image, relu);
  for (size_t i = 1; i < 3; ++i) x = stem_[i](compute, x, relu);
  x = max_pool_3x3_stride_2(compute, x);
  std::array<FeatureMap, 4> out;
  for (size_t i = 0; i < 4; ++i) {
    if (i > 0) x = down_[i - 1](compute, x, relu);
    out[i] = widen_[i](compute, x);
  }
  return out;
}

void VitAdapter::inject(Compute& compute, const Injector& injector, Matrix& tokens, const Matrix& prior,
                        const Matrix& reference, const std::vector<MapSize>& sizes) const {
  const Matrix update = injector.attention(compute, injector.query_norm(compute, tokens), reference,
                                           injector.feature_norm(compute, prior), sizes);
  if (NetworkDevice* const device = compute.device()) {
    device->add_scaled(tokens.data.change_on(*device), update.data.on(*device), tokens.rows, tokens.columns, nullptr,
                       injector.gamma.on(*device));
    return;
  }
  add_scaled(tokens.data.data(), update.data.data(), tokens.rows, tokens.columns, nullptr, injector.gamma.data());
}

void VitAdapter::extract(Compute& compute, const Extractor& extractor, Matrix& prior, const Matrix& tokens,
                         const Matrix& reference, const std::vector<MapSize>& sizes, const MapSize& grid) const {
  Matrix update = extractor.attention(compute, extractor.query_norm(compute, prior), reference,
                                      extractor.feature_norm(compute, tokens), {grid});
  add_values(prior.data, update.data);
  const Matrix hidden = extractor.fc1(compute, extractor.ffn_norm(compute, prior));
  Matrix mixed(hidden.rows, hidden.columns);
  int64_t first = 0;
  NetworkDevice* const device = compute.device();
  for (const MapSize& size : sizes) {
    if (device) {
      extractor.depthwise.apply_on(*device, hidden.data.on(*device) + first * hidden.columns, size.height, size.width,
                                   mixed.data.change_on(*device) + first * mixed.columns);
    } else {
      extractor.depthwise.apply(compute, hidden.row(first), size.height, size.width, mixed.row(first));
    }
    first += size.places();
  }
  if (device) {
    device->add_bias_and_activate(mixed.data.change_on(*device), mixed.rows, mixed.columns, nullptr, Activation::kGelu);
  } else {
    add_bias_and_activate(mixed.data.data(), mixed.rows, mixed.columns, nullptr, Activation::kGelu);
  }
  update = extractor.fc2(compute, mixed);
  add_values(prior.data, update.data);
}

std::array<FeatureMap, 4> VitAdapter::operator()(Compute& compute, const FeatureMap& image) const {
  if (image.height < kMultiple || image.width < kMultiple || image.height % kMultiple != 0 ||
      image.width % kMultiple != 0) {
    throw_bad_input({}, "image",
                    "a size of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                        " does not suit the network",
                    "both sides must be multiples of 32");
  }
  const int64_t c = channels();
  std::array<FeatureMap, 4> maps = spatial_prior(compute, image);
  std::vector<MapSize> sizes;
  Matrix prior(0, c), prior_reference(0, 2);
  for (size_t i = 1; i < 4; ++i) {
    sizes.push_back({maps[i].height, maps[i].width});
    Matrix rows = std::move(maps[i]).take_rows();
    const float* embed = level_embed_.data() + int64_t(i - 1) * c;
    for (int64_t r = 0; r < rows.rows; ++r) {
      for (int64_t k = 0; k < c; ++k) rows.row(r)[k] += embed[k];
    }
    prior = rows_below(prior, rows);
    prior_reference = rows_below(prior_reference, reference_points(sizes.back().height, sizes.back().width));
  }
  const VitTokens embedded = vit_.embed(compute, {image});
  const MapSize grid{embedded.grid_height, embedded.grid_width};
  const Matrix reference = reference_points(grid.height, grid.width);
  Matrix cls = rows_of(embedded.tokens, 0, 1), tokens = rows_of(embedded.tokens, 1, grid.places());
  std::vector<Matrix> outputs;
  for (const Interaction& interaction : interactions_) {
    inject(compute, interaction.injector, tokens, prior, reference, sizes);
    Matrix x = rows_below(cls, tokens);
    for (int b = interaction.first_block; b <= interaction.last_block; ++b)
      vit_.blocks()[size_t(b)].forward(compute, x, 1);
    cls = rows_of(x, 0, 1);
    tokens = rows_of(x, 1, grid.places());
    for (const Extractor& extractor : interaction.extractors)
      extract(compute, extractor, prior, tokens, prior_reference, sizes, grid);
    outputs.push_back(tokens);
  }
  int64_t first = 0;
  for (size_t i = 1; i < 4; ++i) {
    const MapSize& size = sizes[i - 1];
    maps[i] = FeatureMap(size.height, size.width, rows_of(prior, first, size.places()));
    first += size.places();
  }
  add_map(maps[0], up_(compute, maps[1]));
  for (size_t i = 0; i < 4; ++i) {
    const Matrix& output = outputs[std::min(i, outputs.size() - 1)];
    add_map(maps[i], resize_bilinear_map(compute, FeatureMap(grid.height, grid.width, output), maps[i].height,
                                         maps[i].width, false));
    norms_[i].apply(compute, maps[i]);
  }
  return maps;
}

}  // namespace aligngs::nn
