#include "nn/mask2former.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

/// [1, queries, height, width] from places times queries.
void compare_masks(Case& test, const std::string& name, const nn::FeatureMap& masks) {
  test.compare(name, nchw({masks}), nchw_shape({masks}));
}

}  // namespace

void run_mask2former(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  nn::Mask2FormerOptions options;
  options.adapter.vit.heads = config.at("heads").get<int64_t>();
  options.adapter.blocks = {};
  for (const Json& blocks : config.at("inter"))
    options.adapter.blocks.push_back({blocks.front().get<int>(), blocks.back().get<int>()});
  options.heads = config.at("head_heads").get<int64_t>();
  options.groups = config.at("groups").get<int64_t>();
  const nn::Mask2Former network(compute, test.weights("weights.safetensors"), options);

  for (const nn::FeatureMap& crop : maps_of(test.array("in_crop"))) {
    const std::array<nn::FeatureMap, 4> maps = network.backbone()(compute, crop);
    for (size_t i = 0; i < maps.size(); ++i)
      test.compare("out_f" + std::to_string(i + 1), nchw({maps[i]}), nchw_shape({maps[i]}));
    const nn::PixelDecoder::Output pixels = network.pixel_decoder()(compute, maps);
    compare_masks(test, "out_mask_feature", pixels.mask_features);
    for (size_t i = 0; i < pixels.memories.size(); ++i)
      compare_masks(test, "out_memory_" + std::to_string(i), pixels.memories[i]);
    nn::Mask2Former::DecodingHooks hooks;
    hooks.visit = [&](int layer, const nn::Mask2Former::Prediction& p) {
      const std::string n = std::to_string(layer);
      test.compare("out_cls_" + n, p.classes.data, {1, p.classes.rows, p.classes.columns});
      compare_masks(test, "out_mask_" + n, p.masks);
    };
    // A mask logit near zero flips with any rounding to bfloat16, and all that follows is another
    // result. With the reference's masks every layer is compared on its own; what the flips do to
    // probabilities and labels shows below, where the network uses its own.
    if (test.mode().options.precision == nn::Precision::kBfloat16) {
      hooks.masks = [&](int layer) {
        return maps_of(test.array("out_mask_" + std::to_string(layer))).front();
      };
    }
    compare_masks(test, "out_seg_lowres",
                  network.scores_of(network.decode(compute, pixels, hooks)));
  }
  const nn::SlidingWindow window{config.at("crop").at(0), config.at("crop").at(1),
                                 config.at("stride").at(0), config.at("stride").at(1)};
  const int64_t height = config.at("ori").at(0), width = config.at("ori").at(1);
  for (const nn::FeatureMap& image : maps_of(test.array("in_image"))) {
    nn::FeatureMap map = nn::segmentation_logits(compute, network, image, window, height, width);
    nn::softmax_channels(compute, map);
    compare_masks(test, "out_slide_probs", map);
    const std::vector<int> labels = nn::argmax_channels(map);
    test.compare_labels("out_slide_labels", {labels.begin(), labels.end()}, {1, height, width});
  }
}

}  // namespace aligngs::parity
