// Monocular metric depth with DINOv2: the DPT head and the linear heads.
#pragma once

#include <memory>
#include <vector>

#include "nn/dpt_parts.h"
#include "nn/vit.h"

namespace aligngs::nn {

struct DepthOptions {
  VitOptions vit;
  std::vector<int> layers;   ///< of the backbone; empty: those of the published models
  double min_depth = 0.001;  ///< metres
  double max_depth = 10;     ///< metres: 10 for NYU, 80 for KITTI
};

class DepthNetwork {
 public:
  virtual ~DepthNetwork() = default;
  /// The head alone, on a normalised image whose sides are multiples of the patch: metres,
  /// unclamped, one channel, at the head's resolution.
  virtual FeatureMap head(Compute& compute, const FeatureMap& padded) const = 0;

  /// Sides of the images of head() are multiples of it.
  int64_t patch() const { return vit_.patch(); }
  /// Metres at the size of a normalised image, clamped to the range.
  FeatureMap operator()(Compute& compute, const FeatureMap& image) const;

 protected:
  DepthNetwork(const Compute& compute, const Weights& backbone, const DepthOptions& options);

  DepthOptions options_;
  Vit vit_;
};

/// backbone: a plain DINOv2 file; head: tensors "decode_head.*". The tensors decide which of the
/// heads it is. Hugging Face files: see huggingface.h.
std::unique_ptr<DepthNetwork> make_depth_network(const Compute& compute, const Weights& backbone, const Weights& head,
                                                 const DepthOptions& options = {});

}  // namespace aligngs::nn
