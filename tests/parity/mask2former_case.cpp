#include "nn/mask2former.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "nn/ops/resize.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

// A query looks at the places whose mask logit is not negative. In bfloat16 a logit near zero may
// round across that threshold. The query then looks elsewhere, and every later result differs,
// however exact the arithmetic. So results are judged with the network's own masks first. Only if
// these exceed the limits, the network gets the reference's masks, layer by layer. It must then
// keep every limit, mask logits included. This shows that masks differ only where the reference's
// logit lies within the tolerance of the threshold. Some must differ, or the excess has another
// cause.

/// Mask bits that differ between two maps of logits once both are brought to a level's size.
int64_t flipped(nn::Compute& compute, const nn::FeatureMap& a, const nn::FeatureMap& b, const nn::FeatureMap& level) {
  const nn::FeatureMap x = nn::resize_bilinear_map(compute, a, level.height, level.width, false);
  const nn::FeatureMap y = nn::resize_bilinear_map(compute, b, level.height, level.width, false);
  int64_t count = 0;
  for (size_t i = 0; i < x.data.size(); ++i) count += (x.data[i] < 0) != (y.data[i] < 0);
  return count;
}

struct Output {
  std::vector<float> values;
  Shape shape;  ///< of one image
};

/// Everything the case compares on its crops, joined over them.
struct Decoded {
  std::map<std::string, Output> outputs;
  int64_t flips = 0;  ///< mask bits unlike those that were given

  void add(const std::string& name, const std::vector<float>& values, const Shape& shape) {
    Output& output = outputs[name];
    output.shape = shape;
    output.values.insert(output.values.end(), values.begin(), values.end());
  }
  void add(const std::string& name, const nn::FeatureMap& map) {
    add(name, nchw({map}), {map.channels, map.height, map.width});
  }
};

/// `given_masks`: every layer looks where the reference's does.
Decoded decode_crops(Case& test, nn::Compute& compute, const nn::Mask2Former& network, bool given_masks) {
  Decoded decoded;
  const std::vector<nn::FeatureMap> crops = maps_of(test.array("in_crop"));
  for (size_t n = 0; n < crops.size(); ++n) {
    const std::array<nn::FeatureMap, 4> maps = network.backbone()(compute, crops[n]);
    for (size_t i = 0; i < maps.size(); ++i) decoded.add("out_f" + std::to_string(i + 1), maps[i]);
    const nn::PixelDecoder::Output pixels = network.pixel_decoder()(compute, maps);
    decoded.add("out_mask_feature", pixels.mask_features);
    for (size_t i = 0; i < pixels.memories.size(); ++i)
      decoded.add("out_memory_" + std::to_string(i), pixels.memories[i]);
    nn::Mask2Former::DecodingHooks hooks;
    nn::FeatureMap own;
    hooks.visit = [&](int layer, const nn::Mask2Former::Prediction& p) {
      const std::string l = std::to_string(layer);
      decoded.add("out_cls_" + l, p.classes.data, {p.classes.rows, p.classes.columns});
      decoded.add("out_mask_" + l, p.masks);
      own = p.masks;
    };
    if (given_masks) {
      hooks.masks = [&](int layer) {
        nn::FeatureMap masks = maps_of(test.array("out_mask_" + std::to_string(layer))).at(n);
        decoded.flips += flipped(compute, own, masks, pixels.memories[size_t(layer) % 3]);
        return masks;
      };
    }
    decoded.add("out_seg_lowres", network.scores_of(network.decode(compute, pixels, hooks)));
  }
  return decoded;
}

void compare_crops(Case& test, nn::Compute& compute, const nn::Mask2Former& network) {
  Decoded decoded = decode_crops(test, compute, network, false);
  if (test.mode().options.precision == nn::Precision::kBfloat16) {
    std::string worst;
    double most = 0;
    for (const auto& [name, output] : decoded.outputs) {
      if (!test.has(name + ".npy")) continue;
      const Case::Distance d = test.distance(name, output.values);
      const double excess = std::max(d.max / test.mode().max_limit, d.rms / test.mode().rms_limit);
      if (excess <= 1 || excess <= most) continue;
      most = excess;
      char text[120];
      std::snprintf(text, sizeof text, "%s max %.1e, rms %.1e", name.c_str(), d.max, d.rms);
      worst = text;
    }
    if (!worst.empty()) {
      decoded = decode_crops(test, compute, network, true);
      test.note("with its own masks " + worst + "; mask bits that flip: " + std::to_string(decoded.flips) +
                "; compared with the reference's masks");
      if (decoded.flips == 0) test.fail("in_crop", worst + ", though no mask differs");
    }
  }
  for (const auto& [name, output] : decoded.outputs) {
    Shape shape = output.shape;
    int64_t one = 1;
    for (const int64_t side : shape) one *= side;
    shape.insert(shape.begin(), int64_t(output.values.size()) / one);
    test.compare(name, output.values, shape);
  }
}

/// A network whose layers look where those of the float32 network do.
class WithMasksOf : public nn::SegmentationNetwork {
 public:
  WithMasksOf(const nn::Mask2Former& network, const nn::Mask2Former& exact, nn::Compute& compute)
      : network_(network), exact_(exact), compute_(compute) {}
  int64_t classes() const override { return network_.classes(); }

  nn::FeatureMap predict(nn::Compute& compute, const nn::FeatureMap& window) const override {
    std::vector<nn::FeatureMap> masks;
    nn::Mask2Former::DecodingHooks record, replay;
    record.visit = [&](int, const nn::Mask2Former::Prediction& p) { masks.push_back(p.masks); };
    exact_.decode(compute_, exact_.pixel_decoder()(compute_, exact_.backbone()(compute_, window)), record);
    const auto pixels = network_.pixel_decoder()(compute, network_.backbone()(compute, window));
    nn::FeatureMap own;
    replay.visit = [&](int, const nn::Mask2Former::Prediction& p) { own = p.masks; };
    replay.masks = [&](int layer) {
      flips_ += flipped(compute, own, masks.at(size_t(layer)), pixels.memories[size_t(layer) % 3]);
      return masks.at(size_t(layer));
    };
    return nn::resize_bilinear_map(compute, network_.scores_of(network_.decode(compute, pixels, replay)), window.height,
                                   window.width, false);
  }
  /// Mask bits unlike those of the float32 network, of all windows so far.
  int64_t flips() const { return flips_; }

 private:
  const nn::Mask2Former &network_, &exact_;
  nn::Compute& compute_;  ///< of the float32 network
  mutable int64_t flips_ = 0;
};

struct Slid {
  std::vector<float> probabilities, labels;
};

/// Probabilities and labels of all images of the case at height x width.
Slid slide_all(nn::Compute& compute, const nn::SegmentationNetwork& network, const std::vector<nn::FeatureMap>& images,
               const nn::SlidingWindow& window, int64_t height, int64_t width) {
  Slid out;
  for (const nn::FeatureMap& image : images) {
    nn::FeatureMap map = nn::segmentation_logits(compute, network, image, window, height, width);
    nn::softmax_channels(compute, map);
    const std::vector<float> values = nchw({map});
    const std::vector<int> labels = nn::argmax_channels(map);
    out.probabilities.insert(out.probabilities.end(), values.begin(), values.end());
    out.labels.insert(out.labels.end(), labels.begin(), labels.end());
  }
  return out;
}

/// The network's own result. In bfloat16, if that exceeds the limits, the one with the masks of the
/// float32 network (the case has none for its windows). Its own labels must be near even then.
Slid judged_result(Case& test, nn::Compute& compute, const nn::Mask2Former& network,
                   const nn::Mask2FormerOptions& options, const std::vector<nn::FeatureMap>& images,
                   const nn::SlidingWindow& window, int64_t height, int64_t width) {
  const Slid own = slide_all(compute, network, images, window, height, width);
  if (test.mode().options.precision != nn::Precision::kBfloat16 || !test.has("out_slide_probs.npy")) return own;
  const Case::Distance distance = test.distance("out_slide_probs", own.probabilities);
  const double differ = test.distance("out_slide_labels", own.labels).different;
  if (distance.max <= test.mode().max_limit && distance.rms <= test.mode().rms_limit &&
      differ <= test.mode().label_limit)
    return own;
  char text[160];
  std::snprintf(text, sizeof text, "with its own masks: probabilities max %.1e, rms %.1e, %.1f %% of labels differ",
                distance.max, distance.rms, 100 * differ);
  test.note(text);
  constexpr double kLabelsWithFlippedMasks = 0.1;
  if (differ > kLabelsWithFlippedMasks) test.fail("out_slide_labels", text);
  nn::Compute exact(compute.pool(), {});
  const nn::Mask2Former reference(exact, test.weights("weights.safetensors"), options);
  const WithMasksOf given(network, reference, exact);
  Slid slid = slide_all(compute, given, images, window, height, width);
  if (given.flips() == 0) test.fail("in_image", std::string(text) + ", though no mask differs");
  return slid;
}

}  // namespace

void run_mask2former(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  nn::Mask2FormerOptions options;
  options.adapter.vit.heads = config.at("heads").get<int64_t>();
  options.adapter.deformable_heads = value_or(config, "deform_heads", int64_t(0));
  options.adapter.blocks = {};
  for (const Json& blocks : config.at("inter"))
    options.adapter.blocks.push_back({blocks.front().get<int>(), blocks.back().get<int>()});
  options.heads = config.at("head_heads").get<int64_t>();
  options.groups = config.at("groups").get<int64_t>();
  const nn::Mask2Former network(compute, test.weights("weights.safetensors"), options);

  compare_crops(test, compute, network);
  const nn::SlidingWindow window = sliding_window(config);
  const int64_t height = config.at("ori").at(0), width = config.at("ori").at(1);
  const std::vector<nn::FeatureMap> images = maps_of(test.array("in_image"));
  const Slid slid = judged_result(test, compute, network, options, images, window, height, width);
  const int64_t count = int64_t(images.size());
  test.compare("out_slide_probs", slid.probabilities, {count, network.classes(), height, width});
  test.compare_labels("out_slide_labels", slid.labels, {count, height, width});
}

}  // namespace aligngs::parity
