#include "nn/da3/metric.h"

#include "core/error.h"
#include "nn/da3/da3.h"
#include "nn/da3/metric_scale.h"

namespace aligngs::nn {

Da3Metric::Da3Metric(Compute& compute, const Weights& file, const Da3MetricOptions& options) {
  const Weights weights = da3_part(file, "da3_metric");
  const Weights backbone = weights.sub("backbone.pretrained.");
  head_.emplace(compute, weights.sub("head."));
  Da3TrunkOptions trunk;
  trunk.heads = options.heads;
  trunk.layers = options.layers;
  trunk.alternate_from = trunk.rotate_from = -1;
  trunk.joined = false;
  constexpr int kPublishedDepth = 24;
  if (trunk.layers.empty() && backbone.count("blocks.") == kPublishedDepth) trunk.layers = {4, 11, 17, 23};
  trunk_.emplace(compute, backbone, trunk);
  if (head_->inputs() != trunk_->width()) {
    throw Error({ErrorKind::kWeights,
                 "the head reads tokens of " + std::to_string(head_->inputs()) + " values, the trunk has " +
                     std::to_string(trunk_->width()),
                 {},
                 "head.projects.0.weight",
                 "these are not the weights of this network"});
  }
}

FeatureMap Da3Metric::operator()(Compute& compute, const FeatureMap& image) const {
  const Da3Tokens tokens = (*trunk_)(compute, {image}, {});
  return (*head_)(compute, tokens.maps_of(compute, 0), image.height, image.width);
}

void fill_da3_sky(std::vector<FeatureMap>& maps) {
  constexpr size_t kFewest = 10;
  constexpr double kFar = 0.99;
  std::vector<float> ground;
  size_t sky = 0;
  for (const FeatureMap& map : maps) {
    const float* const v = map.data.data();
    for (int64_t i = 0; i < map.places(); ++i) {
      if (v[2 * i + 1] < kDa3SkyThreshold) {
        ground.push_back(v[2 * i]);
      } else {
        ++sky;
      }
    }
  }
  if (ground.size() <= kFewest || sky <= kFewest) return;
  const float far = float(quantile_of(std::move(ground), kFar));
  for (FeatureMap& map : maps) {
    float* const v = map.data.data();
    for (int64_t i = 0; i < map.places(); ++i) {
      if (!(v[2 * i + 1] < kDa3SkyThreshold)) v[2 * i] = far;
    }
  }
}

}  // namespace aligngs::nn
