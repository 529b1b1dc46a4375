// DINOv2 vision transformers (ViT-S, B, L, g; with and without registers), and the variants of them
// inside VGGT, Mask2Former, DA3, EoMT and LingBot-Vision. A network that changes what happens between
// the blocks calls embed() and the blocks itself.
#pragma once

#include <optional>
#include <vector>

#include "nn/ops/convolution.h"
#include "nn/transformer_block.h"

namespace aligngs::nn {

/// How the trained position embedding is brought to another grid.
enum class PositionRule {
  kScaleOffset,             ///< bicubic, called with a scale factor of (grid + 0.1) / trained (no registers)
  kAntialiased,             ///< antialiased bicubic by size (registers, VGGT)
  kAntialiasedScaleOffset,  ///< antialiased bicubic with such a scale factor
  kPlain,                   ///< bicubic by size (Mask2Former's backbone)
  kPatchTable,              ///< a table of the patches alone that is never resized (EoMT)
  kNone                     ///< nothing is added (LingBot-Vision, whose queries and keys turn instead)
};

/// Settings that the weights do not hold. The defaults are those of the published models.
struct VitOptions {
  int64_t heads = 0;                     ///< 0: channels / 64
  std::optional<PositionRule> position;  ///< default: by the presence of registers
  double position_offset = 0.1;          ///< of the rules with a scale factor
  float eps = 1e-6f;                     ///< of the LayerNorms
  bool patches_cut = false;              ///< sides need not be multiples of the patch; the rest is cut
  float norm_eps = 0;                    ///< of the final norm; 0: as in the blocks
  /// Queries and keys of the patches turn with their place, by rope_embed.periods of the weights.
  bool rotated = false;
};

/// Tokens of all images of a batch, in the order cls, registers, patches (row-major).
struct VitTokens {
  int64_t images = 0, grid_height = 0, grid_width = 0, registers = 0;
  Matrix tokens;               ///< after the last block, before the final norm
  std::vector<Matrix> blocks;  ///< outputs of the blocks asked for, in their order

  int64_t per_image() const { return 1 + registers + grid_height * grid_width; }
  /// The patch tokens of an image as a map, and its cls token.
  FeatureMap patches(const Matrix& of, int64_t image = 0) const;
  std::vector<float> cls(const Matrix& of, int64_t image = 0) const;
};

class Vit {
 public:
  Vit(const Compute& compute, const Weights& weights, const VitOptions& options = {});

  int64_t channels() const { return channels_; }
  int64_t patch() const { return patch_embed_.shape().stride; }
  int64_t depth() const { return int64_t(blocks_.size()); }
  const std::vector<TransformerBlock>& blocks() const { return blocks_; }

  /// Normalised images of one size, whose sides are multiples of the patch. Error{kBadInput}
  /// otherwise. `keep`: blocks (0-based) whose outputs are wanted.
  VitTokens operator()(Compute& compute, const std::vector<FeatureMap>& images,
                       const std::vector<int>& keep = {}) const;
  /// The final norm of the network (where its weights have one).
  Matrix normed(Compute& compute, const Matrix& tokens) const { return norm_(compute, tokens); }

  /// The input of the blocks.
  VitTokens embed(Compute& compute, const std::vector<FeatureMap>& images) const;
  /// cls (row 0) and patches of the position embedding for a grid. Error{kBadInput} for a grid that
  /// a table of the patches alone does not have.
  Matrix positions(Compute& compute, int64_t grid_height, int64_t grid_width) const;
  /// By which queries and keys turn on a grid; none: they do not.
  std::optional<TokenPlaces> rotation(int64_t grid_height, int64_t grid_width) const;

 private:
  void load_positions(const Weights& weights);

  VitOptions options_;
  PositionRule rule_ = PositionRule::kScaleOffset;
  int64_t channels_ = 0;
  Convolution patch_embed_;
  std::vector<float> cls_, registers_;
  Matrix position_;             ///< cls, then the trained square grid
  std::vector<float> periods_;  ///< of the rotation
  std::vector<TransformerBlock> blocks_;
  LayerNorm norm_;
};

}  // namespace aligngs::nn
