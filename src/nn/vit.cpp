#include "nn/vit.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/array_shape.h"
#include "nn/ops/blocks.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

int64_t square_side(int64_t places) {
  const auto side = int64_t(std::lround(std::sqrt(double(places))));
  return side * side == places ? side : 0;
}

}  // namespace

FeatureMap VitTokens::patches(const Matrix& of, int64_t image) const {
  FeatureMap map(grid_height, grid_width, of.columns);
  const int64_t first = (image * per_image() + 1 + registers) * of.columns;
  copy_block(map.data, {}, of.data, {first, 0}, 1, map.places() * map.channels);
  return map;
}

std::vector<float> VitTokens::cls(const Matrix& of, int64_t image) const {
  Values row(static_cast<size_t>(of.columns));
  copy_block(row, {}, of.data, {image * per_image() * of.columns, 0}, 1, of.columns);
  return row;
}

Vit::Vit(const Compute& compute, const Weights& weights, const VitOptions& options) : options_(options) {
  const char* const kPatch = "patch_embed.proj.weight";
  channels_ = weights.dimension(kPatch, 0);
  const int64_t c = channels_, patch = weights.dimension(kPatch, 2);
  constexpr int64_t kHeadDim = 64;  // of every published model
  if (options_.heads <= 0) options_.heads = c / kHeadDim;
  patch_embed_ = Convolution(compute, weights, "patch_embed.proj", {c, 3, patch, patch, 0, true});
  cls_ = weights.load("cls_token", {1, 1, c});
  if (weights.has("register_tokens"))
    registers_ = weights.load("register_tokens", {1, weights.dimension("register_tokens", 1), c});
  rule_ = options_.position.value_or(registers_.empty() ? PositionRule::kScaleOffset : PositionRule::kAntialiased);
  load_positions(weights);
  if (options_.rotated) {
    periods_ = weights.load("rope_embed.periods", {c / std::max<int64_t>(options_.heads, 1) / 4});
    for (const float period : periods_) {
      if (!(period > 0)) {
        throw Error({ErrorKind::kWeights,
                     "a period is not positive",
                     {},
                     "rope_embed.periods",
                     "these are not the weights of this network, or they are damaged"});
      }
    }
  }
  const int depth = weights.count("blocks.");
  if (depth == 0) weights.shape("blocks.0.norm1.weight");  // throws: missing
  for (int i = 0; i < depth; ++i) {
    blocks_.emplace_back(compute, weights.sub("blocks." + std::to_string(i) + "."),
                         TransformerBlock::Config{c, options_.heads, options_.eps, options_.rotated});
  }
  const float norm_eps = options_.norm_eps > 0 ? options_.norm_eps : options_.eps;
  if (weights.has("norm.weight")) norm_ = LayerNorm(weights, "norm", c, norm_eps);
}

void Vit::load_positions(const Weights& weights) {
  if (rule_ == PositionRule::kNone) return;
  const int64_t c = channels_, own = rule_ == PositionRule::kPatchTable ? 0 : 1;  // of the cls token
  const Shape shape = weights.shape("pos_embed");
  const int64_t places = shape.size() >= 2 ? shape[shape.size() - 2] : 0;
  if (square_side(places - own) == 0) {
    throw Error(
        {ErrorKind::kWeights,
         "shape " + shape_text(shape) + " found, expected a square number of places" + (own > 0 ? " and one more" : ""),
         {},
         "pos_embed",
         "these are not the weights of this network"});
  }
  const std::vector<float> values =
      weights.load("pos_embed", shape.size() == 2 ? Shape{places, c} : Shape{1, places, c});
  position_ = Matrix(places + 1 - own, c);
  std::copy(values.begin(), values.end(), position_.row(1 - own));
}

std::optional<TokenPlaces> Vit::rotation(int64_t grid_height, int64_t grid_width) const {
  if (periods_.empty()) return std::nullopt;
  // Each axis runs from -1 to 1 whatever its length; a period is in these units.
  constexpr double kTwoPi = 6.283185307179586;
  std::vector<double> angles(periods_.size());  // place 0, of the special tokens: no turn
  const auto append_axis = [&](int64_t length) {
    for (int64_t i = 0; i < length; ++i) {
      const double at = 2 * (double(i) + 0.5) / double(length) - 1;
      for (const float period : periods_) angles.push_back(kTwoPi * at / double(period));
    }
  };
  append_axis(grid_height);
  append_axis(grid_width);
  TokenPlaces places{Rope2d(channels_ / options_.heads, angles), {}};
  places.places.resize(size_t(1 + int64_t(registers_.size()) / channels_));
  for (int64_t y = 0; y < grid_height; ++y) {
    for (int64_t x = 0; x < grid_width; ++x) places.places.push_back({int(1 + y), int(1 + grid_height + x)});
  }
  return places;
}

Matrix Vit::positions(Compute& compute, int64_t grid_height, int64_t grid_width) const {
  if (rule_ == PositionRule::kNone) return Matrix(1 + grid_height * grid_width, channels_);
  const int64_t side = square_side(position_.rows - 1);
  if (grid_height == side && grid_width == side) return position_;
  if (rule_ == PositionRule::kPatchTable) {
    throw_bad_input({}, "images",
                    "a grid of " + std::to_string(grid_width) + " x " + std::to_string(grid_height) +
                        " patches does not suit the network",
                    "it takes images of " + std::to_string(side * patch()) + " x " + std::to_string(side * patch()) +
                        " pixels only");
  }
  FeatureMap trained(side, side, channels_);
  std::copy_n(position_.row(1), trained.data.size(), trained.data.data());
  const auto axis = [&](int64_t grid) {
    const double offset_step = double(side) / (double(grid) + options_.position_offset);
    switch (rule_) {
      case PositionRule::kAntialiased:
        return antialiased_bicubic_axis(side, grid);
      case PositionRule::kScaleOffset:
        return bicubic_axis(side, grid, offset_step);
      case PositionRule::kAntialiasedScaleOffset:
        return antialiased_bicubic_axis(side, grid, offset_step);
      case PositionRule::kPlain:
      case PositionRule::kPatchTable:
      case PositionRule::kNone:
        break;
    }
    return bicubic_axis(side, grid, double(side) / double(grid));
  };
  const FeatureMap resized = resample(compute, trained, axis(grid_height), axis(grid_width));
  Matrix out(1 + grid_height * grid_width, channels_);
  std::copy_n(position_.row(0), channels_, out.row(0));
  std::copy(resized.data.begin(), resized.data.end(), out.row(1));
  return out;
}

VitTokens Vit::embed(Compute& compute, const std::vector<FeatureMap>& images) const {
  VitTokens out;
  out.images = int64_t(images.size());
  if (images.empty()) throw_bad_input({}, "images", "none given");
  const FeatureMap& first = images.front();
  for (const FeatureMap& image : images) {
    const bool whole = image.height % patch() == 0 && image.width % patch() == 0;
    if (image.height != first.height || image.width != first.width || image.height < patch() || image.width < patch() ||
        !(whole || options_.patches_cut)) {
      throw_bad_input({}, "images",
                      "a size of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                          " does not suit the network",
                      "all images must have one size, sides multiples of " + std::to_string(patch()));
    }
  }
  out.grid_height = first.height / patch();
  out.grid_width = first.width / patch();
  out.registers = int64_t(registers_.size()) / channels_;
  out.tokens = Matrix(out.images * out.per_image(), channels_);
  const Matrix position = positions(compute, out.grid_height, out.grid_width);
  // The start of every image; then the patches are added.
  Matrix base(out.per_image(), channels_);
  const float* const first_place = position.row(0);
  float* to = base.row(0);
  for (int64_t c = 0; c < channels_; ++c) to[c] = cls_[size_t(c)] + first_place[c];
  to = std::copy(registers_.begin(), registers_.end(), to + channels_);
  std::copy_n(position.row(1), (position.rows - 1) * channels_, to);
  const int64_t size = out.per_image() * channels_, special = (1 + out.registers) * channels_;
  for (int64_t i = 0; i < out.images; ++i) {
    copy_block(out.tokens.data, {i * size, 0}, base.data, {}, 1, size);
  }
  for (int64_t i = 0; i < out.images; ++i) {
    const FeatureMap patches = patch_embed_(compute, images[size_t(i)]);
    add_block(out.tokens.data, {i * size + special, 0}, patches.data, {}, 1, size - special);
  }
  return out;
}

VitTokens Vit::operator()(Compute& compute, const std::vector<FeatureMap>& images, const std::vector<int>& keep) const {
  VitTokens out = embed(compute, images);
  const std::optional<TokenPlaces> places = rotation(out.grid_height, out.grid_width);
  out.blocks.resize(keep.size());
  for (size_t i = 0; i < blocks_.size(); ++i) {
    blocks_[i].forward(compute, out.tokens, out.images, places ? &*places : nullptr);
    for (size_t k = 0; k < keep.size(); ++k) {
      if (keep[k] == int(i)) out.blocks[k] = out.tokens;
    }
  }
  for (size_t k = 0; k < keep.size(); ++k) {
    if (out.blocks[k].rows == 0) {
      throw Error({ErrorKind::kWeights,
                   "block " + std::to_string(keep[k]) + " is wanted of a network of " + std::to_string(blocks_.size()),
                   {},
                   "blocks",
                   "these are not the weights of this network"});
    }
  }
  return out;
}

}  // namespace aligngs::nn
