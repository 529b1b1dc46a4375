// Semantic segmentation: what all networks for it share, from a photograph to class probabilities.
#pragma once

#include <vector>

#include "nn/preprocess/normalised_image.h"
#include "nn/sliding_window.h"

namespace aligngs::nn {

class SegmentationNetwork {
 public:
  virtual ~SegmentationNetwork() = default;
  virtual int64_t classes() const = 0;
  /// Logits or scores [height, width, classes] of a normalised image or window of that size.
  virtual FeatureMap predict(Compute& compute, const FeatureMap& window) const = 0;
};

/// How a photograph is shown to the network.
struct SegmentationPlan {
  SegmentationResize resize;
  SlidingWindow window;
  std::vector<double> ratios = {1.0};  ///< of the resized image; probabilities are averaged
  bool flip = false;                   ///< mirrored as well

  /// Images of one photograph that the network sees.
  size_t images() const { return ratios.size() * (flip ? 2 : 1); }
  /// The size of an image at `ratio` times that of the plan.
  SegmentationResize resize_at(double ratio) const;
};

/// The published settings: linear heads (crop 512), multi-scale heads (crop 640, with augmentation
/// or without), Mask2Former (crop 896).
SegmentationPlan linear_plan();
SegmentationPlan multi_scale_plan(bool augmented);
SegmentationPlan mask2former_plan();

/// Averaged over windows, at height x width: logits or scores.
FeatureMap segmentation_logits(Compute& compute, const SegmentationNetwork& network, const FeatureMap& normalised,
                               const SlidingWindow& window, int64_t height, int64_t width);
/// The photograph (RGB of 8 bits) as the network sees it, `ratio` times the size of the plan.
FeatureMap shown_image(const Image<uint8_t>& photo, const SegmentationPlan& plan, double ratio);
/// Probabilities [height, width, classes], averaged over the ratios of the plan and over mirrored images.
FeatureMap segment(Compute& compute, const SegmentationNetwork& network, const Image<uint8_t>& photo,
                   const SegmentationPlan& plan, int64_t height, int64_t width);

void softmax_channels(Compute& compute, FeatureMap& map);
/// The channel of the largest value per place; the first of equal ones.
std::vector<int> argmax_channels(const FeatureMap& map);

}  // namespace aligngs::nn
