#include "nn/vggt_aggregator.h"

#include <algorithm>

#include "core/error.h"
#include "nn/ops/blocks.h"
#include "nn/preprocess/normalised_image.h"

namespace aligngs::nn {
namespace {

constexpr float kBlockEps = 1e-5f;

}  // namespace

VggtAggregator::VggtAggregator(const Compute& compute, const Weights& weights, int64_t heads) {
  VitOptions options;
  options.heads = heads;
  options.position = PositionRule::kAntialiased;
  encoder_ = std::make_unique<Vit>(compute, weights.sub("patch_embed."), options);
  const int64_t c = channels();
  heads_ = heads > 0 ? heads : c / 64;
  const int64_t registers = weights.dimension("register_token", 2);
  const std::vector<float> camera = weights.load("camera_token", {1, 2, 1, c});
  const std::vector<float> others = weights.load("register_token", {1, 2, registers, c});
  for (int k = 0; k < 2; ++k) {
    special_[k].assign(camera.begin() + k * c, camera.begin() + (k + 1) * c);
    special_[k].insert(special_[k].end(), others.begin() + k * registers * c, others.begin() + (k + 1) * registers * c);
  }
  const int depth = weights.count("frame_blocks.");
  if (depth == 0) weights.shape("frame_blocks.0.norm1.weight");  // throws: missing
  const TransformerBlock::Config config{c, heads_, kBlockEps};
  for (int i = 0; i < depth; ++i) {
    const std::string n = std::to_string(i) + ".";
    frame_blocks_.emplace_back(compute, weights.sub("frame_blocks." + n), config);
    global_blocks_.emplace_back(compute, weights.sub("global_blocks." + n), config);
  }
}

AggregatedTokens VggtAggregator::operator()(Compute& compute, std::vector<FeatureMap> images,
                                            const std::vector<int>& keep, bool keep_patch_tokens) const {
  for (FeatureMap& image : images) normalise_unit_image(image);
  const int64_t c = channels();
  AggregatedTokens out;
  Matrix x;
  {
    const VitTokens encoded = (*encoder_)(compute, images);
    images.clear();
    const Matrix normed = encoder_->normed(compute, encoded.tokens);
    out.frames = encoded.images;
    out.grid_height = encoded.grid_height;
    out.grid_width = encoded.grid_width;
    out.special = int64_t(special_[0].size()) / c;
    const int64_t patches = out.grid_height * out.grid_width;
    x = Matrix(out.frames * out.per_frame(), c);
    if (keep_patch_tokens) out.patch_tokens = Matrix(out.frames * patches, c);
    for (int64_t f = 0; f < out.frames; ++f) {
      const std::vector<float>& special = special_[f == 0 ? 0 : 1];
      std::copy(special.begin(), special.end(), x.row(f * out.per_frame()));
    }
    for (int64_t f = 0; f < out.frames; ++f) {
      const Block from{((f + 1) * encoded.per_image() - patches) * c, 0};
      copy_block(x.data, {(f * out.per_frame() + out.special) * c, 0}, normed.data, from, 1, patches * c);
      if (keep_patch_tokens) copy_block(out.patch_tokens.data, {f * patches * c, 0}, normed.data, from, 1, patches * c);
    }
  }
  // Special tokens are at (0, 0), patches from (1, 1) on.
  TokenPlaces places{Rope2d(c / heads_, std::max(out.grid_height, out.grid_width)), {}};
  places.places.resize(size_t(out.special));
  for (int y = 1; y <= int(out.grid_height); ++y) {
    for (int i = 1; i <= int(out.grid_width); ++i) places.places.push_back({y, i});
  }
  out.layers.resize(keep.size());
  for (size_t layer = 0; layer < frame_blocks_.size(); ++layer) {
    frame_blocks_[layer].forward(compute, x, out.frames, &places);
    Matrix joined;
    const bool wanted = std::find(keep.begin(), keep.end(), int(layer)) != keep.end();
    if (wanted) {
      joined = Matrix(x.rows, 2 * c);
      copy_block(compute, joined.data, {0, 2 * c}, x.data, {0, c}, x.rows, c);
    }
    global_blocks_[layer].forward(compute, x, 1, &places);
    if (!wanted) continue;
    copy_block(compute, joined.data, {c, 2 * c}, x.data, {0, c}, x.rows, c);
    for (size_t k = 0; k < keep.size(); ++k) {
      if (keep[k] == int(layer)) out.layers[k] = joined;
    }
  }
  for (size_t k = 0; k < keep.size(); ++k) {
    if (out.layers[k].rows == 0) {
      throw Error({ErrorKind::kWeights,
                   "layer " + std::to_string(keep[k]) + " is wanted of a trunk of " + std::to_string(depth()),
                   {},
                   "aggregator",
                   "these are not the weights of this network"});
    }
  }
  return out;
}

}  // namespace aligngs::nn
