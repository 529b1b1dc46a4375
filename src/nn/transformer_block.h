// The pre-norm transformer block of DINOv2, and of the networks that are built of it.
#pragma once

#include <vector>

#include "nn/ops/linear.h"
#include "nn/ops/norm.h"
#include "nn/ops/rope.h"

namespace aligngs::nn {

/// The place of each token of a sequence; sequences longer than the list repeat it.
struct TokenPlaces {
  struct Place {
    int y = 0, x = 0;
  };
  Rope2d rope;
  std::vector<Place> places;
};

/// x += ls1 * proj(attention(norm1(x))); x += ls2 * ffn(norm2(x)). The weights decide the rest: normalised queries and
/// keys (attn.q_norm), LayerScale (ls1.gamma or gamma1, none), biases that do not count (attn.qkv.bias_mask). The
/// feed-forward part is mlp.fc1 with GELU, or SwiGLU as mlp.w12 or as mlp.w1 and mlp.w2.
class TransformerBlock {
 public:
  struct Config {
    int64_t channels = 0, heads = 0;
    float eps = 1e-6f;  ///< of norm1 and norm2
    /// The weights pair value i of a head with i + head_dim / 2, as DINOv3's rotation does: y and x
    /// lie side by side in each half. Loading puts queries and keys in the order of Rope2d, which
    /// changes no product of theirs.
    bool halves_paired = false;
  };
  TransformerBlock(const Compute& compute, const Weights& weights, const Config& config);

  /// x [sequences * tokens, channels]; attention within each sequence.
  void forward(Compute& compute, Matrix& x, int64_t sequences, const TokenPlaces* places = nullptr) const;

 private:
  void attend(Compute& compute, const Matrix& x, int64_t sequences, const TokenPlaces* places, Matrix& out) const;
  void forward_on(NetworkDevice& device, Compute& compute, Matrix& x, int64_t sequences,
                  const TokenPlaces* places) const;

  Config config_;
  LayerNorm norm1_, norm2_, q_norm_, k_norm_;
  Values scale1_, scale2_;
  Linear qkv_, proj_, fc1_, fc2_;
  bool gated_ = false;
};

}  // namespace aligngs::nn
