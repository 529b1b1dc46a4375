#include "nn/segmentation.h"

#include <algorithm>
#include <utility>

#include "nn/cpu/row_kernels.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {

SegmentationPlan linear_plan() {
  SegmentationPlan plan;
  plan.resize.short_side = 512;
  plan.window = {512, 512, 341, 341};
  return plan;
}

SegmentationPlan multi_scale_plan(bool augmented) {
  SegmentationPlan plan;
  plan.resize.short_side = 640;
  plan.window = {640, 640, 320, 320};
  if (augmented) {
    plan.ratios = {1.0, 1.32, 1.73, 2.28, 3.0};
    plan.flip = true;
  }
  return plan;
}

SegmentationPlan mask2former_plan() {
  SegmentationPlan plan;
  plan.resize.short_side = 896;
  plan.resize.multiple = 32;
  plan.window = {896, 896, 512, 512};
  return plan;
}

void softmax_channels(Compute& compute, FeatureMap& map) {
  constexpr int64_t kChunk = 256;
  compute.for_rows(map.places(), kChunk, [&](int64_t begin, int64_t count, Scratch&) {
    softmax_rows(map.data.data() + begin * map.channels, count, map.channels);
  });
}

std::vector<int> argmax_channels(const FeatureMap& map) {
  std::vector<int> labels;
  labels.reserve(size_t(map.places()));
  for (int64_t p = 0; p < map.places(); ++p) {
    const float* v = map.data.data() + p * map.channels;
    labels.push_back(int(std::max_element(v, v + map.channels) - v));
  }
  return labels;
}

FeatureMap segmentation_logits(Compute& compute, const SegmentationNetwork& network, const FeatureMap& normalised,
                               const SlidingWindow& window, int64_t height, int64_t width) {
  const FeatureMap logits =
      slide(compute, normalised, window, [&](const FeatureMap& part) { return network.predict(compute, part); });
  return resize_bilinear_map(compute, logits, height, width, false);
}

SegmentationResize SegmentationPlan::resize_at(double ratio) const {
  SegmentationResize scaled = resize;
  // mmseg scales the limits, not the image.
  scaled.short_side = int(resize.short_side * ratio);
  if (resize.long_side < 1 << 20) scaled.long_side = int(resize.long_side * ratio);
  return scaled;
}

FeatureMap shown_image(const Image<uint8_t>& photo, const SegmentationPlan& plan, double ratio) {
  return normalised_image(segmentation_image(photo, plan.resize_at(ratio)));
}

FeatureMap segment(Compute& compute, const SegmentationNetwork& network, const Image<uint8_t>& photo,
                   const SegmentationPlan& plan, int64_t height, int64_t width) {
  FeatureMap mean;
  const float share = 1.0f / float(plan.images());
  for (const double ratio : plan.ratios) {
    const FeatureMap image = shown_image(photo, plan, ratio);
    for (int mirrored = 0; mirrored <= int(plan.flip); ++mirrored) {
      FeatureMap probabilities = segmentation_logits(compute, network, mirrored ? flip_horizontally(image) : image,
                                                     plan.window, height, width);
      softmax_channels(compute, probabilities);
      if (plan.images() == 1) return probabilities;
      if (mirrored) probabilities = flip_horizontally(probabilities);
      if (mean.data.empty()) mean = FeatureMap(height, width, probabilities.channels);
      compute.for_rows(height, 1, [&](int64_t y, int64_t, Scratch&) {
        const float* from = std::as_const(probabilities).at(y, 0);
        float* to = mean.at(y, 0);
        for (int64_t i = 0; i < width * mean.channels; ++i) to[i] += share * from[i];
      });
    }
  }
  return mean;
}

}  // namespace aligngs::nn
