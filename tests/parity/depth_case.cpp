#include "nn/depther.h"
#include "nn/huggingface.h"
#include "nn/preprocess/normalised_image.h"
#include "parity_case.h"

namespace aligngs::parity {

void run_depth(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  nn::DepthOptions options;
  options.vit = vit_options(config);
  options.layers = config.at("layers").get<std::vector<int>>();
  options.min_depth = config.at("min").get<double>();
  options.max_depth = config.at("max").get<double>();
  const auto network =
      nn::make_depth_network(compute, test.weights("backbone.safetensors"), test.weights("head.safetensors"), options);
  const std::vector<nn::FeatureMap> images = maps_of(test.array("in_image"));
  std::vector<nn::FeatureMap> raw, depth;
  for (const nn::FeatureMap& image : images) {
    raw.push_back(network->head(compute, nn::centre_padded(image, network->patch())));
    depth.push_back((*network)(compute, image));
  }
  test.compare("out_head_raw", nchw(raw), nchw_shape(raw));
  test.compare("out_depth", nchw(depth), nchw_shape(depth));
  if (!test.has("hf_model.safetensors")) return;

  const auto file = WeightFile::open(test.folder() / "hf_model.safetensors");
  if (!nn::is_huggingface_dpt(*file)) test.fail("hf_model.safetensors", "not recognised");
  nn::DepthOptions unshifted = options;
  unshifted.min_depth = 0;  // transformers does not add it
  const auto same = nn::make_depth_network(compute, nn::dinov2_from_huggingface(file, "backbone."),
                                           nn::dpt_head_from_huggingface(file), unshifted);
  std::vector<float> predicted;
  Shape shape;
  for (const nn::FeatureMap& image : images) {
    const nn::FeatureMap map = same->head(compute, nn::centre_padded(image, same->patch()));
    predicted.insert(predicted.end(), map.data.begin(), map.data.end());
    shape = {int64_t(images.size()), map.height, map.width};
  }
  test.compare("out_hf_predicted_depth", predicted, shape);
}

}  // namespace aligngs::parity
