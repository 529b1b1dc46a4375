// ViT-Adapter (Chen et al. 2023): a plain transformer that gives maps at four scales.
#pragma once

#include <array>
#include <vector>

#include "nn/ops/deformable_attention.h"
#include "nn/vit.h"

namespace aligngs::nn {

struct AdapterOptions {
  VitOptions vit;  ///< position and eps are set here as the adapter needs
  /// First and last block of each interaction; empty: equal shares.
  std::vector<std::array<int, 2>> blocks;
  int64_t deformable_heads = 0;  ///< 0: from the tensors, with 4 points per level
};

class VitAdapter {
 public:
  /// `weights`: the tensors below "backbone.".
  VitAdapter(const Compute& compute, const Weights& weights, const AdapterOptions& options = {});

  int64_t channels() const { return vit_.channels(); }
  /// Maps at 1/4, 1/8, 1/16 and 1/32 of a normalised image whose sides are multiples of 32
  /// (Error{kBadInput} otherwise).
  std::array<FeatureMap, 4> operator()(Compute& compute, const FeatureMap& image) const;

 private:
  /// Brings what the convolutions see into the tokens.
  struct Injector {
    LayerNorm query_norm, feature_norm;
    DeformableAttention attention;
    Values gamma;
  };
  /// Brings what the tokens know back.
  struct Extractor {
    LayerNorm query_norm, feature_norm, ffn_norm;
    DeformableAttention attention;
    Linear fc1, fc2;
    DepthwiseConvolution depthwise;
  };
  struct Interaction {
    Injector injector;
    std::vector<Extractor> extractors;
    int first_block = 0, last_block = 0;
  };
  Extractor make_extractor(const Compute& compute, const Weights& weights, int64_t deformable_heads) const;
  std::array<FeatureMap, 4> spatial_prior(Compute& compute, const FeatureMap& image) const;
  void inject(Compute& compute, const Injector& injector, Matrix& tokens, const Matrix& prior, const Matrix& reference,
              const std::vector<MapSize>& sizes) const;
  void extract(Compute& compute, const Extractor& extractor, Matrix& prior, const Matrix& tokens,
               const Matrix& reference, const std::vector<MapSize>& sizes, const MapSize& grid) const;

  Vit vit_;
  std::array<Convolution, 3> stem_;
  std::array<Convolution, 3> down_;  ///< conv2 to conv4
  std::array<Linear, 4> widen_;      ///< fc1 to fc4
  std::vector<float> level_embed_;   ///< [3, channels]
  std::vector<Interaction> interactions_;
  TransposedConvolution up_;
  std::array<BatchNorm, 4> norms_;
};

}  // namespace aligngs::nn
