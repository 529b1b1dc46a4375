#include "nn/depther.h"

#include <algorithm>

#include "core/error.h"
#include "nn/ops/blocks.h"
#include "nn/ops/resize.h"
#include "nn/preprocess/normalised_image.h"

namespace aligngs::nn {
namespace {

/// The four layers that the published heads read.
std::vector<int> published_depther_layers(int64_t depth) {
  if (depth == 24) return {4, 11, 17, 23};
  const int quarter = int(depth / 4);  // 12: 2, 5, 8, 11; 40: 9, 19, 29, 39
  return {quarter - 1, 2 * quarter - 1, 3 * quarter - 1, 4 * quarter - 1};
}

/// The map with the cls token beside every place.
FeatureMap with_cls(const VitTokens& tokens, size_t layer) {
  const Matrix& all = tokens.blocks[layer];
  const int64_t c = all.columns;
  FeatureMap out(tokens.grid_height, tokens.grid_width, 2 * c);
  copy_block(out.data, {0, 2 * c}, all.data, {(1 + tokens.registers) * c, c}, out.places(), c);
  copy_block(out.data, {c, 2 * c}, all.data, {0, 0}, out.places(), c);
  return out;
}

class DptDepth : public DepthNetwork {
 public:
  DptDepth(const Compute& compute, const Weights& backbone, const Weights& head, const DepthOptions& options)
      : DepthNetwork(compute, backbone, options) {
    if (options_.layers.empty()) options_.layers = published_depther_layers(vit_.depth());
    if (options_.layers.size() != 4) throw_usage("a DPT head reads four layers", "correct the list of layers");
    const int64_t c = vit_.channels();
    const int64_t features = head.dimension("convs.0.conv.weight", 0);
    for (int j = 0; j < 4; ++j) {
      const std::string n = std::to_string(j);
      readouts_.emplace_back(compute, head, "reassemble_blocks.readout_projects." + n + ".0", c, 2 * c);
      levels_.emplace_back(compute, head, j,
                           DptLevel::Names{"reassemble_blocks.projects." + n + ".conv",
                                           "reassemble_blocks.resize_layers." + n, "convs." + n + ".conv"},
                           c, features);
      const std::string p = "fusion_blocks." + n + ".";
      const auto unit = [&](const std::string& name) {
        return ResidualUnit(compute, head, p + name + ".conv1.conv", p + name + ".conv2.conv", features, false);
      };
      Fusion fusion;
      if (j > 0) fusion.unit1 = unit("res_conv_unit1");
      fusion.unit2 = unit("res_conv_unit2");
      fusion.project = Linear(compute, head, p + "project.conv", features, features);
      fusions_.push_back(std::move(fusion));
    }
    project_ = Convolution(compute, head, "project.conv", {features, features, 3, 1, 1});
    const int64_t half = head.dimension("conv_depth.head.0.weight", 0);
    const int64_t last = head.dimension("conv_depth.head.2.weight", 0);
    output1_ = Convolution(compute, head, "conv_depth.head.0", {half, features, 3, 1, 1});
    output2_ = Convolution(compute, head, "conv_depth.head.2", {last, half, 3, 1, 1});
    output3_ = Linear(compute, head, "conv_depth.head.4", 1, last);
  }

  FeatureMap head(Compute& compute, const FeatureMap& padded) const override {
    const VitTokens tokens = vit_(compute, {padded}, options_.layers);
    std::vector<FeatureMap> maps;
    for (size_t j = 0; j < levels_.size(); ++j) {
      FeatureMap map = readouts_[j](compute, with_cls(tokens, j), Activation::kGelu);
      map = levels_[j].resize(compute, levels_[j].project(compute, map));
      maps.push_back(levels_[j].features(compute, map));
    }
    FeatureMap out = std::move(maps.back());
    for (size_t k = 0; k < fusions_.size(); ++k) {
      const Fusion& fusion = fusions_[k];
      if (k > 0) {
        FeatureMap& finer = maps[maps.size() - 1 - k];
        if (finer.height != out.height || finer.width != out.width)  // odd grids
          finer = resize_bilinear_map(compute, finer, out.height, out.width, false);
        add_map(out, fusion.unit1(compute, finer));
      }
      out = fusion.unit2(compute, out);
      // As in VGGT's head, the 1x1 convolution is done before the resizing it commutes with.
      out = resize_bilinear_map(compute, fusion.project(compute, out), 2 * out.height, 2 * out.width, true);
    }
    out = output1_(compute, project_(compute, out, {false, Activation::kRelu}));
    out = resize_bilinear_map(compute, out, 2 * out.height, 2 * out.width, true);
    out = output3_(compute, output2_(compute, out, {false, Activation::kRelu}), Activation::kRelu);
    for (float& v : out.data) v += float(options_.min_depth);
    return out;
  }

 private:
  struct Fusion {
    ResidualUnit unit1, unit2;
    Linear project;
  };
  std::vector<Linear> readouts_;
  std::vector<DptLevel> levels_;
  std::vector<Fusion> fusions_;  ///< coarsest first
  Convolution project_, output1_, output2_;
  Linear output3_;
};

/// Depth as the mean of bins; one or four layers of the backbone.
class LinearDepth : public DepthNetwork {
 public:
  LinearDepth(const Compute& compute, const Weights& backbone, const Weights& head, const DepthOptions& options)
      : DepthNetwork(compute, backbone, options) {
    const int64_t inputs = head.dimension("conv_depth.weight", 1);
    const int64_t layers = inputs / (2 * vit_.channels());
    if (options_.layers.empty()) {
      options_.layers = layers == 4 ? published_depther_layers(vit_.depth()) : std::vector<int>{int(vit_.depth()) - 1};
    }
    bins_ = Linear(compute, head, "conv_depth", head.dimension("conv_depth.weight", 0),
                   2 * vit_.channels() * int64_t(options_.layers.size()));
  }

  FeatureMap head(Compute& compute, const FeatureMap& padded) const override {
    const VitTokens tokens = vit_(compute, {padded}, options_.layers);
    FeatureMap joined(tokens.grid_height, tokens.grid_width, bins_.inputs());
    for (size_t j = 0; j < options_.layers.size(); ++j) {
      const FeatureMap map = with_cls(tokens, j);
      copy_block(joined.data, {int64_t(j) * map.channels, joined.channels}, map.data, {0, map.channels}, map.places(),
                 map.channels);
    }
    // The 1x1 convolution commutes with the resizing of its input.
    const FeatureMap logits =
        resize_bilinear_map(compute, bins_(compute, joined), 4 * joined.height, 4 * joined.width, false);
    FeatureMap out(logits.height, logits.width, 1);
    const int64_t bins = logits.channels;
    for (int64_t p = 0; p < logits.places(); ++p) {
      const float* l = logits.data.data() + p * bins;
      double total = 0, mean = 0;
      for (int64_t k = 0; k < bins; ++k) {
        constexpr double kFloor = 0.1;  // every bin keeps some weight
        const double weight = std::max(double(l[k]), 0.0) + kFloor;
        const double depth =
            options_.min_depth + (options_.max_depth - options_.min_depth) * double(k) / double(bins - 1);
        total += weight;
        mean += weight * depth;
      }
      out.data[size_t(p)] = float(mean / total);
    }
    return out;
  }

 private:
  Linear bins_;
};

}  // namespace

DepthNetwork::DepthNetwork(const Compute& compute, const Weights& backbone, const DepthOptions& options)
    : options_(options), vit_(compute, backbone, options.vit) {
  if (!(options.min_depth < options.max_depth))
    throw_usage("the smallest depth is not below the largest", "correct the range of depth");
}

FeatureMap DepthNetwork::operator()(Compute& compute, const FeatureMap& image) const {
  FeatureMap depth = head(compute, centre_padded(image, vit_.patch()));
  for (float& v : depth.data) v = std::clamp(v, float(options_.min_depth), float(options_.max_depth));
  // The map of the padded image is stretched to the image, as published.
  return resize_bilinear_map(compute, depth, image.height, image.width, false);
}

std::unique_ptr<DepthNetwork> make_depth_network(const Compute& compute, const Weights& backbone, const Weights& head,
                                                 const DepthOptions& options) {
  const Weights weights = head.sub("decode_head.");
  if (weights.has("conv_depth.weight")) return std::make_unique<LinearDepth>(compute, backbone, weights, options);
  return std::make_unique<DptDepth>(compute, backbone, weights, options);
}

}  // namespace aligngs::nn
