// The trunk of Depth Anything 3 (Lin et al. 2025): a DINOv2 transformer. Its later blocks attend within each view and
// across all views in turn.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "nn/da3/reference_view.h"
#include "nn/vit.h"

namespace aligngs::nn {

/// Settings that the tensors do not hold. The defaults are those of the published networks.
struct Da3TrunkOptions {
  int64_t heads = 0;        ///< 0: by the width of the norms of queries, else channels / 64
  std::vector<int> layers;  ///< blocks (0-based) that the heads read; empty: by the depth
  /// From here on odd blocks attend across views, and a camera token takes the place of the class token. Default: the
  /// first block that normalises its queries; -1: never.
  std::optional<int> alternate_from;
  std::optional<int> rotate_from;  ///< first block whose queries and keys turn; default: alternate_from
  bool joined = true;              ///< tokens are those of the last local block and of the block itself, side by side
};

/// The request for one pass.
struct Da3TrunkRequest {
  Matrix camera_tokens;  ///< [views, channels] of given cameras; empty: none are given
  Da3ReferenceRule rule = Da3ReferenceRule::kSaddleBalanced;
  /// A view that is the reference whatever the rule; not with given cameras, of which the first is it.
  std::optional<int64_t> reference;
  /// Sees the tokens [views * (1 + patches), channels] after each block, in the order of work: the reference first.
  std::function<void(int, const Matrix&)> visit;
};

struct Da3Tokens {
  int64_t views = 0, grid_height = 0, grid_width = 0;
  int64_t reference = 0;                ///< view that was the first of the order of work
  std::vector<float> reference_scores;  ///< empty where nothing was chosen by score
  /// Per layer [views * patches, width]: local tokens as they are | normed tokens, in the order of the photos.
  std::vector<Matrix> layers;
  Matrix camera;  ///< [views, width]: the first token of each view after the last layer, not normed

  int64_t patches() const { return grid_height * grid_width; }
  /// The maps of one view, a map per layer.
  std::vector<FeatureMap> maps_of(Compute& compute, int64_t view) const;
};

class Da3Trunk {
 public:
  /// `weights`: the tensors below "backbone.pretrained.". Error{kWeights} when they do not fit, or when the layers are
  /// neither given nor known for this depth.
  Da3Trunk(const Compute& compute, const Weights& weights, const Da3TrunkOptions& options);

  /// Normalised images of one size, sides multiples of the patch. Error{kBadInput} otherwise.
  Da3Tokens operator()(Compute& compute, const std::vector<FeatureMap>& images, const Da3TrunkRequest& request) const;

  const Vit& vit() const { return vit_; }
  const std::vector<int>& layers() const { return layers_; }
  int64_t width() const { return (joined_ ? 2 : 1) * vit_.channels(); }  ///< of a token that the heads read

 private:
  void set_camera_tokens(Matrix& x, const Matrix& given, int64_t views) const;

  Vit vit_;
  int64_t heads_ = 0;
  std::vector<int> layers_;
  int alternate_from_ = -1, rotate_from_ = -1;
  bool joined_ = true;
  Matrix camera_token_;  ///< of the reference, of the others
};

}  // namespace aligngs::nn
