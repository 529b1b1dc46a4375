// Weights of full size with random values, where aligngs looks for published ones: proves shapes,
// memory and time of every command without the publishers' files. The results mean nothing.
// Usage: random_weights FOLDER MODEL...      then: ALIGNGS_MODELS=FOLDER aligngs poses ...
// MODEL: names of `aligngs models list`, e.g. vggt-1b ade20k-linear-s lpips-vgg
#include <chrono>
#include <cstdio>
#include <string>

#include "core/error.h"
#include "nn/random_weights.h"
#include "priors/model_store.h"

namespace aligngs {
namespace {

nn::TensorList tensors_of(const PublishedModel& model, size_t file) {
  const auto is = [&](const char* family) { return model.name.rfind(family, 0) == 0; };
  if (is("vggt-")) return nn::vggt_tensors({});
  if (is("ade20k-m2f")) return nn::mask2former_tensors({});
  if (is("da3metric-")) return nn::da3_metric_tensors();
  if (is("da3-")) return nn::da3_tensors(nn::da3_size(model.name[4]));
  if (is("eomt-l-panoptic")) return nn::eomt_tensors({{1024, 24, false, 4, 40}, 200});
  if (is("eomt-")) return nn::eomt_tensors();
  if (is("lingbot-")) return nn::lingbot_tensors();
  if (is("lpips-")) return file == 0 ? nn::vgg16_tensors() : nn::lpips_tensors();
  const nn::VitSize size = nn::vit_size(model.name.back());
  if (is("dinov2-")) return nn::dinov2_tensors(size);
  if (is("ade20k-linear-")) return nn::bn_head_tensors(size.channels);
  if (is("ade20k-ms-")) return nn::bn_head_tensors(4 * size.channels);
  if (is("nyu-dpt-")) return nn::dpt_head_tensors(size);
  return nn::linear_depth_tensors(4 * 2 * size.channels);  // nyu-linear4-
}

void write_model(const ModelStore& store, const PublishedModel& model) {
  for (size_t i = 0; i < model.files.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    const std::filesystem::path path = store.own_path(model, model.files[i]);
    constexpr uint64_t kSeed = 1;
    nn::write_random_weights(path, tensors_of(model, i), kSeed);
    std::printf("%s: %.2f GB in %.1f s\n", path.c_str(), double(std::filesystem::file_size(path)) / 1e9,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
}

}  // namespace
}  // namespace aligngs

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("usage: random_weights FOLDER MODEL...   (names: aligngs models list)\n", stderr);
    return 2;
  }
  try {
    aligngs::ModelStoreOptions options;
    options.folder = argv[1];
    const aligngs::ModelStore store(options);
    for (int i = 2; i < argc; ++i) {
      for (const aligngs::PublishedModel* model : aligngs::with_needs(aligngs::published_model(argv[i])))
        aligngs::write_model(store, *model);
    }
    return 0;
  } catch (const aligngs::Error& error) {
    std::fprintf(stderr, "random_weights: %s\n", error.what());
    return error.exit_status();
  }
}
