#include "nn/mask2former.h"

#include <cstdio>

#include "nn/ops/resize.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

/// [queries, height, width] from places times queries.
void collect_masks(Case& test, const std::string& name, const nn::FeatureMap& masks) {
  test.collect(name, nchw({masks}), {masks.channels, masks.height, masks.width});
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
    exact_.decode(compute_, exact_.pixel_decoder()(compute_, exact_.backbone()(compute_, window)),
                  record);
    replay.masks = [&](int layer) { return masks.at(size_t(layer)); };
    const auto pixels = network_.pixel_decoder()(compute, network_.backbone()(compute, window));
    return nn::resize_bilinear_map(
        compute, network_.scores_of(network_.decode(compute, pixels, replay)), window.height,
        window.width, false);
  }

 private:
  const nn::Mask2Former &network_, &exact_;
  nn::Compute& compute_;  ///< of the float32 network
};

struct Slid {
  std::vector<float> probabilities, labels;
};

/// Probabilities and labels of all images of the case at height x width.
Slid slide_all(nn::Compute& compute, const nn::SegmentationNetwork& network,
               const std::vector<nn::FeatureMap>& images, const nn::SlidingWindow& window,
               int64_t height, int64_t width) {
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

/// A mask logit near zero changes its sign with any rounding to bfloat16, the query looks elsewhere,
/// and all that follows is another result. Where that takes the network over the limits, it must
/// keep them with the masks of the float32 network, and its own labels must still be near.
Slid judged_result(Case& test, nn::Compute& compute, const nn::Mask2Former& network,
                   const nn::Mask2FormerOptions& options,
                   const std::vector<nn::FeatureMap>& images, const nn::SlidingWindow& window,
                   int64_t height, int64_t width) {
  const Slid own = slide_all(compute, network, images, window, height, width);
  if (test.mode().options.precision != nn::Precision::kBfloat16 || !test.has("out_slide_probs.npy"))
    return own;
  const Case::Distance distance = test.distance("out_slide_probs", own.probabilities);
  const double differ = test.distance("out_slide_labels", own.labels).different;
  if (distance.max <= test.mode().max_limit && distance.rms <= test.mode().rms_limit &&
      differ <= test.mode().label_limit)
    return own;
  char text[160];
  std::snprintf(text, sizeof text,
                "with its own masks: probabilities max %.1e, rms %.1e, %.1f %% of labels differ",
                distance.max, distance.rms, 100 * differ);
  test.note(text);
  constexpr double kLabelsWithFlippedMasks = 0.1;
  if (differ > kLabelsWithFlippedMasks) test.fail("out_slide_labels", text);
  nn::Compute exact(compute.pool(), {});
  const nn::Mask2Former reference(exact, test.weights("weights.safetensors"), options);
  return slide_all(compute, WithMasksOf(network, reference, exact), images, window, height, width);
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

  const std::vector<nn::FeatureMap> crops = maps_of(test.array("in_crop"));
  for (size_t n = 0; n < crops.size(); ++n) {
    const std::array<nn::FeatureMap, 4> maps = network.backbone()(compute, crops[n]);
    for (size_t i = 0; i < maps.size(); ++i)
      collect_masks(test, "out_f" + std::to_string(i + 1), maps[i]);
    const nn::PixelDecoder::Output pixels = network.pixel_decoder()(compute, maps);
    collect_masks(test, "out_mask_feature", pixels.mask_features);
    for (size_t i = 0; i < pixels.memories.size(); ++i)
      collect_masks(test, "out_memory_" + std::to_string(i), pixels.memories[i]);
    nn::Mask2Former::DecodingHooks hooks;
    hooks.visit = [&](int layer, const nn::Mask2Former::Prediction& p) {
      const std::string l = std::to_string(layer);
      test.collect("out_cls_" + l, p.classes.data, {p.classes.rows, p.classes.columns});
      collect_masks(test, "out_mask_" + l, p.masks);
    };
    // A mask logit near zero flips with any rounding to bfloat16, and all that follows is another
    // result. With the reference's masks every layer is compared on its own; what flips do to
    // probabilities and labels shows below, where the network uses its own.
    if (test.mode().options.precision == nn::Precision::kBfloat16) {
      hooks.masks = [&](int layer) {
        return maps_of(test.array("out_mask_" + std::to_string(layer))).at(n);
      };
    }
    collect_masks(test, "out_seg_lowres",
                  network.scores_of(network.decode(compute, pixels, hooks)));
  }
  test.compare_collected();
  const nn::SlidingWindow window = sliding_window(config);
  const int64_t height = config.at("ori").at(0), width = config.at("ori").at(1);
  const std::vector<nn::FeatureMap> images = maps_of(test.array("in_image"));
  const Slid slid = judged_result(test, compute, network, options, images, window, height, width);
  const int64_t count = int64_t(images.size());
  test.compare("out_slide_probs", slid.probabilities, {count, network.classes(), height, width});
  test.compare_labels("out_slide_labels", slid.labels, {count, height, width});
}

}  // namespace aligngs::parity
