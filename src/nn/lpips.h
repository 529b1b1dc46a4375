// Learned perceptual image patch similarity (Zhang et al. 2018), version 0.1 on VGG16.
#pragma once

#include <vector>

#include "core/image.h"
#include "nn/ops/convolution.h"

namespace aligngs::nn {

/// The network's input for an image with values in [0, 1].
enum class LpipsInput {
  kCanonical,  ///< 2 x - 1, as its authors say
  kUnit        ///< x itself, as the tables of the field have it (lower by about a third)
};

class Lpips {
 public:
  /// vgg16: torchvision's "features.*" (vgg16-397923af.pth); linear: "lin0" to "lin4" (the authors'
  /// weights/v0.1/vgg.pth). Error{kWeights} when something is missing.
  Lpips(const Compute& compute, const Weights& vgg16, const Weights& linear);

  /// 0 for equal images. Both RGB in [0, 1], of one size of at least 16 x 16 (Error{kBadInput}).
  double distance(Compute& compute, const ImageF& a, const ImageF& b, LpipsInput input) const;

 private:
  /// Features of the five stages, each place scaled to unit length.
  std::vector<FeatureMap> features(Compute& compute, const ImageF& image, LpipsInput input) const;

  std::vector<std::vector<Convolution>> stages_;
  std::vector<std::vector<float>> weights_;  ///< per channel of a stage
};

}  // namespace aligngs::nn
