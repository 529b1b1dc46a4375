#include "nn/dpt_pyramid.h"

#include <utility>

#include "core/error.h"
#include "nn/ops/blocks.h"
#include "nn/ops/position_encoding.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

constexpr size_t kLevels = 4;
constexpr float kBatchNormEps = 1e-5f;
constexpr float kEmbeddingRatio = 0.1f;  // of the uv embedding

}  // namespace

void add_uv_embedding(Compute& compute, FeatureMap& x, double aspect) {
  if (compute.device()) {
    FeatureMap uv = uv_embedding(x.height, x.width, x.channels, aspect);
    for (float& v : uv.data) v *= kEmbeddingRatio;
    add_values(x.data, uv.data);
    return;
  }
  const UvAxes axes = uv_axes(x.height, x.width, x.channels, aspect);
  const int64_t half = axes.x.columns;
  float* const values = x.data.data();
  compute.for_rows(x.height, 1, [&](int64_t y, int64_t, Scratch&) {
    float* to = values + y * x.width * x.channels;
    for (int64_t column = 0; column < x.width; ++column, to += x.channels) {
      const float *const of_x = axes.x.row(column), *const of_y = axes.y.row(y);
      for (int64_t c = 0; c < half; ++c) {
        to[c] += kEmbeddingRatio * of_x[c];
        to[half + c] += kEmbeddingRatio * of_y[c];
      }
    }
  });
}

DptPyramid::DptPyramid(const Compute& compute, const Weights& weights, const Options& options)
    : options_(options),
      inputs_(weights.dimension("projects.0.weight", 1)),
      features_(weights.dimension("scratch.layer1_rn.weight", 0)) {
  if (options.normed_and_placed) norm_ = LayerNorm(weights, "norm", inputs_, kBatchNormEps);
  for (size_t j = 0; j < kLevels; ++j) {
    const std::string n = std::to_string(j);
    levels_.emplace_back(
        compute, weights, int(j),
        DptLevel::Names{"projects." + n, "resize_layers." + n, "scratch.layer" + std::to_string(j + 1) + "_rn"},
        inputs_, features_);
  }
}

std::vector<FeatureMap> DptPyramid::operator()(Compute& compute, std::vector<FeatureMap> layers, double aspect) const {
  if (layers.size() != kLevels)
    throw Error(
        {ErrorKind::kFailed, "a dense head is given " + std::to_string(layers.size()) + " layers", {}, "layers", ""});
  std::vector<FeatureMap> out;
  for (size_t j = 0; j < kLevels; ++j) {
    FeatureMap map = std::move(layers[j]);
    const int64_t height = map.height, width = map.width;
    if (options_.normed_and_placed) map = FeatureMap(height, width, norm_(compute, std::move(map).take_rows()));
    map = levels_[j].project(compute, map);
    if (options_.normed_and_placed) add_uv_embedding(compute, map, aspect);
    out.push_back(levels_[j].features(compute, levels_[j].resize(compute, std::move(map))));
  }
  return out;
}

DptFusion::DptFusion(const Compute& compute, const Weights& weights, const Options& options) {
  for (size_t j = 0; j < kLevels; ++j) {
    const std::string p = "scratch.refinenet" + std::to_string(j + 1) + options.suffix + ".";
    const int64_t features = weights.dimension(p + "out_conv.weight", 0);
    const auto unit = [&](const std::string& name) {
      return ResidualUnit(compute, weights, p + name + ".conv1", p + name + ".conv2", features, options.rectified_skip);
    };
    Step step;
    if (j + 1 < kLevels) step.unit1 = unit("resConfUnit1");  // the coarsest has nothing to add
    step.unit2 = unit("resConfUnit2");
    step.out = Linear(compute, weights, p + "out_conv", features, features);
    steps_.push_back(std::move(step));
  }
}

FeatureMap DptFusion::operator()(Compute& compute, const std::vector<FeatureMap>& levels) const {
  FeatureMap out;
  for (size_t j = steps_.size(); j-- > 0;) {
    const Step& step = steps_[j];
    if (j + 1 == steps_.size()) {
      out = levels[j];
    } else {
      add_map(out, step.unit1(compute, levels[j]));
    }
    out = step.unit2(compute, out);
    const int64_t height = j > 0 ? levels[j - 1].height : 2 * out.height;
    const int64_t width = j > 0 ? levels[j - 1].width : 2 * out.width;
    // A 1x1 convolution and bilinear resizing commute (the weights of a resampling sum to one): the
    // convolution is done on the smaller map.
    out = resize_bilinear_map(compute, step.out(compute, out), height, width, true);
  }
  return out;
}

}  // namespace aligngs::nn
