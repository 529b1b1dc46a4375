// LingBot-Vision with a linear head.
#include "nn/lingbot.h"
#include "nn/preprocess/normalised_image.h"
#include "nn/preprocess/opencv_resize.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

std::vector<float> rows_of(const nn::Matrix& m, int64_t first, int64_t count) {
  const float* const from = m.row(first);
  return {from, from + count * m.columns};
}

}  // namespace

void run_lingbot(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  const int side = config.at("img_size").get<int>();
  const nn::LingbotNetwork network(compute,
                                   nn::lingbot_weights(WeightFile::open(test.folder() / "weights.safetensors")),
                                   config.at("heads").get<int64_t>());
  const Image<uint8_t> photo = image_of_nchw(test.array("in_image"));
  const Image<uint8_t> square = nn::opencv_resize_linear(photo, side, side);
  test.compare_exactly("out_resized", nchw(square), {1, 3, side, side});
  nn::VitTokens tokens;
  const nn::FeatureMap grid = network.grid_logits(compute, nn::normalised_image(square), &tokens);
  const nn::Matrix normed = network.vit().normed(compute, tokens.tokens);
  const int64_t n = normed.rows, c = normed.columns, special = 1 + tokens.registers;
  test.compare("out_prenorm", tokens.tokens.data, {1, n, c});
  test.compare("out_cls", rows_of(normed, 0, 1), {1, c});
  test.compare("out_storage", rows_of(normed, 1, tokens.registers), {1, tokens.registers, c});
  test.compare("out_patch", rows_of(normed, special, n - special), {1, n - special, c});
  test.compare("out_logits", nchw({grid}), nchw_shape({grid}));
  const nn::FeatureMap logits = network.photo_logits(compute, photo, photo.height, photo.width, side);
  test.compare("out_logits_full", nchw({logits}), nchw_shape({logits}));
  const std::vector<int> labels = nn::argmax_channels(logits);
  test.compare_labels("out_labels", {labels.begin(), labels.end()}, {1, photo.height, photo.width});
  if (!test.has("in_rect.npy")) return;
  const nn::FeatureMap rect =
      network.grid_logits(compute, nn::normalised_image(image_of_nchw(test.array("in_rect"))), &tokens);
  test.compare("out_rect_prenorm", tokens.tokens.data, {1, tokens.tokens.rows, c});
  test.compare("out_rect_logits", nchw({rect}), nchw_shape({rect}));
}

}  // namespace aligngs::parity
