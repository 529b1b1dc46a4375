#include <algorithm>

#include "nn/vit.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

std::vector<float> token_rows(const nn::VitTokens& t, const nn::Matrix& of, int64_t first, int64_t count) {
  std::vector<float> out;
  for (int64_t i = 0; i < t.images; ++i) {
    const float* row = of.row(i * t.per_image() + first);
    out.insert(out.end(), row, row + count * of.columns);
  }
  return out;
}

}  // namespace

void run_vit(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  const nn::Vit vit(compute, test.weights("weights.safetensors"), vit_options(config));
  const auto layers = config.at("layers").get<std::vector<int>>();
  const nn::VitTokens t = vit(compute, maps_of(test.array("in_image")), layers);
  const int64_t n = t.images, c = vit.channels(), patches = t.grid_height * t.grid_width;
  const nn::Matrix normed = vit.normed(compute, t.tokens);
  test.compare("out_prenorm", t.tokens.data, {n, t.per_image(), c});
  test.compare("out_cls", token_rows(t, normed, 0, 1), {n, c});
  test.compare("out_reg", token_rows(t, normed, 1, t.registers), {n, t.registers, c});
  test.compare("out_patch", token_rows(t, normed, 1 + t.registers, patches), {n, patches, c});
  for (size_t j = 0; j < layers.size(); ++j) {
    const nn::Matrix block_normed = vit.normed(compute, t.blocks[j]);
    for (const bool norm : {false, true}) {
      const nn::Matrix& of = norm ? block_normed : t.blocks[j];
      const std::string name = std::string("out_inter_") + (norm ? "norm_" : "") + std::to_string(j);
      std::vector<nn::FeatureMap> maps;
      std::vector<float> cls;
      for (int64_t i = 0; i < n; ++i) {
        maps.push_back(t.patches(of, i));
        const std::vector<float> one = t.cls(of, i);
        cls.insert(cls.end(), one.begin(), one.end());
      }
      test.compare(name, nchw(maps), nchw_shape(maps));
      test.compare(name + "_cls", cls, {n, c});
    }
  }
  const nn::Matrix position = vit.positions(compute, t.grid_height, t.grid_width);
  test.compare("pos_embed_interp", position.data, {1, position.rows, c});
}

}  // namespace aligngs::parity
