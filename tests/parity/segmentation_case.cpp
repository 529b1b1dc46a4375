#include "nn/bn_head.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

std::vector<float> labels_of(const nn::FeatureMap& map) {
  const std::vector<int> labels = nn::argmax_channels(map);
  return {labels.begin(), labels.end()};
}

}  // namespace

void run_segmentation(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  nn::BnHeadOptions options;
  options.vit = vit_options(config);
  options.layers = config.at("layers").get<std::vector<int>>();
  options.in_index = config.at("in_index").get<std::vector<int>>();
  const nn::BnHeadNetwork network(compute, test.weights("backbone.safetensors"), test.weights("head.safetensors"),
                                  options);
  const nn::SlidingWindow window = sliding_window(config);
  const int64_t height = config.at("ori").at(0), width = config.at("ori").at(1);

  std::vector<nn::FeatureMap> logits, probabilities;
  std::vector<float> labels, flipped_labels;
  for (const nn::FeatureMap& image : maps_of(test.array("in_image"))) {
    logits.push_back(network.grid_logits(compute, image));
    for (const bool flip : {false, true}) {
      nn::FeatureMap map =
          nn::segmentation_logits(compute, network, flip ? nn::flip_horizontally(image) : image, window, height, width);
      nn::softmax_channels(compute, map);
      if (flip) map = nn::flip_horizontally(map);
      const std::vector<float> l = labels_of(map);
      std::vector<float>& to = flip ? flipped_labels : labels;
      to.insert(to.end(), l.begin(), l.end());
      if (!flip) probabilities.push_back(std::move(map));
    }
  }
  const int64_t images = int64_t(logits.size());
  test.compare("out_head_logits", nchw(logits), nchw_shape(logits));
  test.compare("out_probs", nchw(probabilities), nchw_shape(probabilities));
  test.compare_labels("out_labels", labels, {images, height, width});
  test.compare_labels("out_labels_flip", flipped_labels, {images, height, width});
}

}  // namespace aligngs::parity
