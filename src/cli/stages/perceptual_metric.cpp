#include "cli/stages/perceptual_metric.h"

#include "core/error.h"
#include "core/log.h"
#include "nn/lpips.h"

namespace aligngs {

struct PerceptualMetric::Network {
  // Float32: the metric is compared with numbers of other programs.
  Network(ThreadPool& pool, const std::filesystem::path& vgg16, const std::filesystem::path& linear)
      : compute(pool), lpips(compute, nn::Weights::open(vgg16), nn::Weights::open(linear)) {}
  nn::Compute compute;
  nn::Lpips lpips;
};

PerceptualMetric::PerceptualMetric(const ModelStore& store, ThreadPool& pool) {
  const PublishedModel& model = published_model("lpips-vgg");
  if (!store.installed(model)) {
    reason_ = "the weights of VGG16 and LPIPS are not on this machine: aligngs models download lpips-vgg";
    return;
  }
  try {
    const std::vector<std::filesystem::path> files = store.require(model);
    network_ = std::make_unique<Network>(pool, files.at(0), files.at(1));
  } catch (const Error& error) {
    reason_ = std::string("the weights cannot be used: ") + error.what();
    log_warning("LPIPS is not measured: {}", error.what());
  }
}

PerceptualMetric::~PerceptualMetric() = default;

std::optional<PerceptualMetric::Distances> PerceptualMetric::measure(const ImageF& rendered, const ImageF& truth,
                                                                     const ImageF& mask) const {
  constexpr int kSmallest = 16;  // pixels; the network halves four times
  if (!network_ || rendered.width < kSmallest || rendered.height < kSmallest) return std::nullopt;
  ImageF masked = rendered;
  for (size_t p = 0; p < mask.data.size(); ++p) {
    if (mask.data[p] > 0) continue;
    for (size_t c = 0; c < 3; ++c) masked.data[3 * p + c] = truth.data[3 * p + c];
  }
  for (float& v : masked.data) v = v < 0 ? 0 : v > 1 ? 1 : v;
  Distances distances;
  distances.canonical = network_->lpips.distance(network_->compute, masked, truth, nn::LpipsInput::kCanonical);
  distances.unit = network_->lpips.distance(network_->compute, masked, truth, nn::LpipsInput::kUnit);
  return distances;
}

}  // namespace aligngs
