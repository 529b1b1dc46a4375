#include "nn/da3/trunk.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "nn/ops/blocks.h"

namespace aligngs::nn {
namespace {

constexpr float kFinalNormEps = 1e-5f;   // unlike DINOv2's
constexpr int64_t kFewestForChoice = 3;  // views

int64_t heads_of(const Weights& weights, int64_t given) {
  if (given > 0) return given;
  const int64_t channels = weights.dimension("patch_embed.proj.weight", 0);
  for (int i = 0; i < weights.count("blocks."); ++i) {
    const std::string name = "blocks." + std::to_string(i) + ".attn.q_norm.weight";
    if (weights.has(name)) return channels / std::max<int64_t>(weights.dimension(name, 0), 1);
  }
  return 0;  // by Vit's rule
}

int first_normed_block(const Weights& weights) {
  for (int i = 0; i < weights.count("blocks."); ++i) {
    if (weights.has("blocks." + std::to_string(i) + ".attn.q_norm.weight")) return i;
  }
  return -1;
}

VitOptions vit_options(int64_t heads) {
  VitOptions options;
  options.heads = heads;
  options.position = PositionRule::kScaleOffset;
  options.norm_eps = kFinalNormEps;
  return options;
}

/// Layers of the published networks: Small and Base, Large, Giant.
std::vector<int> published_da3_layers(int64_t depth) {
  if (depth == 12) return {5, 7, 9, 11};
  if (depth == 24) return {11, 15, 19, 23};
  if (depth == 40) return {19, 27, 33, 39};
  throw Error({ErrorKind::kWeights,
               "no network of " + std::to_string(depth) + " blocks is published",
               {},
               "backbone.pretrained.blocks",
               "use the weights of DA3 Small, Base, Large or Giant"});
}

/// Views of `per_view` values each, in another order.
void reorder(Values& values, const std::vector<int64_t>& order, int64_t per_view) {
  Values out(values.size());
  for (size_t s = 0; s < order.size(); ++s)
    copy_block(out, {int64_t(s) * per_view, 0}, values, {order[s] * per_view, 0}, 1, per_view);
  values = std::move(out);
}

/// Token 0 of every view.
Matrix first_tokens(const Matrix& x, int64_t views) {
  Matrix out(views, x.columns);
  copy_block(out.data, {0, x.columns}, x.data, {0, x.rows / views * x.columns}, views, x.columns);
  return out;
}

/// Class and camera tokens are at (0, 0). Patches begin at (1, 1), across views all of them at (1, 1).
TokenPlaces places_of(const Rope2d& rope, const VitTokens& tokens, bool across) {
  TokenPlaces places{rope, {{0, 0}}};
  for (int y = 1; y <= int(tokens.grid_height); ++y) {
    for (int x = 1; x <= int(tokens.grid_width); ++x)
      places.places.push_back(across ? TokenPlaces::Place{1, 1} : TokenPlaces::Place{y, x});
  }
  return places;
}

/// Collects the tokens of one layer in the order of the photos.
class Collector {
 public:
  Collector(Compute& compute, Da3Tokens& out, const std::vector<int64_t>& order)
      : compute_(compute), out_(out), order_(order) {}

  /// `left` (may be null): the first half of every token.
  void patches(const Matrix* left, const Matrix& right) {
    Matrix layer(out_.views * out_.patches(), width(left, right));
    fill(layer, left, right, out_.patches(), 1);
    out_.layers.push_back(std::move(layer));
  }
  void camera(const Matrix* left, const Matrix& right) {
    out_.camera = Matrix(out_.views, width(left, right));
    fill(out_.camera, left, right, 1, 0);
  }

 private:
  static int64_t width(const Matrix* left, const Matrix& right) { return right.columns * (left ? 2 : 1); }
  /// `count` tokens of each view from token `first` on.
  void fill(Matrix& to, const Matrix* left, const Matrix& right, int64_t count, int64_t first) const {
    const int64_t c = right.columns, per_view = right.rows / out_.views, w = to.columns;
    for (size_t s = 0; s < order_.size(); ++s) {
      const Block from{(int64_t(s) * per_view + first) * c, c};
      const int64_t at = order_[s] * count * w;
      if (left) copy_block(compute_, to.data, {at, w}, left->data, from, count, c);
      copy_block(compute_, to.data, {at + w - c, w}, right.data, from, count, c);
    }
  }

  Compute& compute_;
  Da3Tokens& out_;
  const std::vector<int64_t>& order_;
};

}  // namespace

std::vector<FeatureMap> Da3Tokens::maps_of(Compute& compute, int64_t view) const {
  std::vector<FeatureMap> maps;
  for (const Matrix& layer : layers) {
    FeatureMap map(grid_height, grid_width, layer.columns);
    const int64_t size = patches() * layer.columns;
    copy_block(compute, map.data, {}, layer.data, {view * size, 0}, 1, size);
    maps.push_back(std::move(map));
  }
  return maps;
}

Da3Trunk::Da3Trunk(const Compute& compute, const Weights& weights, const Da3TrunkOptions& options)
    : vit_(compute, weights, vit_options(heads_of(weights, options.heads))),
      layers_(options.layers.empty() ? published_da3_layers(vit_.depth()) : options.layers),
      alternate_from_(options.alternate_from.value_or(first_normed_block(weights))),
      rotate_from_(options.rotate_from.value_or(alternate_from_)),
      joined_(options.joined) {
  constexpr int64_t kHeadDim = 64;
  heads_ = heads_of(weights, options.heads);
  if (heads_ == 0) heads_ = vit_.channels() / kHeadDim;
  weights.shape("norm.weight");  // throws: missing
  for (size_t j = 0; j < layers_.size(); ++j) {
    if (layers_[j] < (j == 0 ? 0 : layers_[j - 1] + 1) || layers_[j] >= vit_.depth())
      throw_usage("the heads need blocks of the trunk in ascending order", "correct the list of layers");
  }
  if (rotate_from_ >= 0 && vit_.channels() / heads_ % 4 != 0) {
    throw Error({ErrorKind::kWeights,
                 "heads of " + std::to_string(vit_.channels() / heads_) + " channels cannot be turned by place",
                 {},
                 "backbone.pretrained",
                 "set the number of heads"});
  }
  if (alternate_from_ < 0) {
    if (options.alternate_from || !weights.has("camera_token")) return;
    throw Error({ErrorKind::kWeights,
                 "no block normalises its queries, so where views begin to mix is unknown",
                 {},
                 "backbone.pretrained.blocks",
                 "these are not the weights of this network"});
  }
  camera_token_ = Matrix(2, vit_.channels());
  camera_token_.data = weights.load("camera_token", {1, 2, vit_.channels()});
}

void Da3Trunk::set_camera_tokens(Matrix& x, const Matrix& given, int64_t views) const {
  const int64_t c = x.columns, stride = x.rows / views * c;
  if (given.rows > 0) {
    copy_block(x.data, {0, stride}, given.data, {0, c}, views, c);
    return;
  }
  copy_block(x.data, {0, stride}, camera_token_.data, {0, c}, 1, c);
  copy_block(x.data, {stride, stride}, camera_token_.data, {c, 0}, views - 1, c);  // the same for all others
}

Da3Tokens Da3Trunk::operator()(Compute& compute, const std::vector<FeatureMap>& images,
                               const Da3TrunkRequest& request) const {
  VitTokens embedded = vit_.embed(compute, images);
  Matrix& x = embedded.tokens;
  Da3Tokens out;
  out.views = embedded.images;
  out.grid_height = embedded.grid_height;
  out.grid_width = embedded.grid_width;
  const bool posed = request.camera_tokens.rows > 0;
  if (posed && (request.camera_tokens.rows != out.views || request.camera_tokens.columns != x.columns))
    throw_bad_input({}, "cameras", "their number is not that of the images", "give one camera per image, or none");
  if (posed && alternate_from_ < 0)
    throw_usage("this network takes no cameras", "give none, or use an any-view network");
  if (request.reference && (posed || alternate_from_ < 1))
    throw_usage("a reference view goes with an any-view network and without given cameras", "name none");
  if (request.reference && (*request.reference < 0 || *request.reference >= out.views))
    throw_usage("the reference is no view of this scene", "name one of the images");

  std::vector<int64_t> order(static_cast<size_t>(out.views));
  std::iota(order.begin(), order.end(), int64_t(0));
  const Rope2d rope(vit_.channels() / heads_, std::max(out.grid_height, out.grid_width));
  const TokenPlaces within = places_of(rope, embedded, false), across = places_of(rope, embedded, true);
  Collector collect(compute, out, order);
  for (int i = 0; i < int(vit_.depth()); ++i) {
    if (i == alternate_from_ - 1 && !posed && (out.views >= kFewestForChoice || request.reference)) {
      const Da3Reference chosen = choose_reference_view(first_tokens(x, out.views), request.rule);
      out.reference = request.reference.value_or(chosen.view);
      out.reference_scores = chosen.scores;
      std::rotate(order.begin(), order.begin() + out.reference, order.begin() + out.reference + 1);
      reorder(x.data, order, x.rows / out.views * x.columns);
    }
    if (i == alternate_from_) set_camera_tokens(x, request.camera_tokens, out.views);
    const bool global = alternate_from_ >= 0 && i >= alternate_from_ && i % 2 == 1;
    const bool wanted = std::find(layers_.begin(), layers_.end(), i) != layers_.end();
    const bool turned = rotate_from_ >= 0 && i >= rotate_from_;
    // The block before a global one is local: what it left is the local half.
    Matrix local;
    if (wanted && global && joined_) local = x;
    vit_.blocks()[size_t(i)].forward(compute, x, global ? 1 : out.views,
                                     turned ? (global ? &across : &within) : nullptr);
    if (request.visit) request.visit(i, x);
    if (!wanted) continue;
    const Matrix* const left = joined_ ? (global ? &local : &x) : nullptr;
    collect.patches(left, vit_.normed(compute, x));
    if (i == layers_.back()) collect.camera(left, x);
  }
  return out;
}

}  // namespace aligngs::nn
