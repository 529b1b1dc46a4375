#include "nn/lpips.h"

#include <cmath>

#include "core/error.h"

namespace aligngs::nn {
namespace {

constexpr int kSmallest = 16;  // pixels: four times halved, one is left

/// torchvision's indices of the convolutions; a ReLU follows each, a pooling each stage.
const std::vector<std::vector<int>>& stage_layers() {
  static const std::vector<std::vector<int>> layers = {{0, 2}, {5, 7}, {10, 12, 14}, {17, 19, 21}, {24, 26, 28}};
  return layers;
}

FeatureMap normalised(const ImageF& image, LpipsInput input) {
  constexpr float kShift[3] = {-0.030f, -0.088f, -0.188f}, kScale[3] = {0.458f, 0.448f, 0.450f};
  FeatureMap out(image.height, image.width, 3);
  for (size_t i = 0; i < out.data.size(); ++i) {
    const float x = input == LpipsInput::kCanonical ? 2 * image.data[i] - 1 : image.data[i];
    out.data[i] = (x - kShift[i % 3]) / kScale[i % 3];
  }
  return out;
}

void scale_to_unit_length(FeatureMap& map) {
  constexpr double kEps = 1e-10;
  for (int64_t p = 0; p < map.places(); ++p) {
    float* v = map.data.data() + p * map.channels;
    double squares = 0;
    for (int64_t c = 0; c < map.channels; ++c) squares += double(v[c]) * double(v[c]);
    const auto scale = float(1 / (std::sqrt(squares) + kEps));
    for (int64_t c = 0; c < map.channels; ++c) v[c] *= scale;
  }
}

}  // namespace

Lpips::Lpips(const Compute& compute, const Weights& vgg16, const Weights& linear) {
  int64_t inputs = 3;
  for (size_t s = 0; s < stage_layers().size(); ++s) {
    std::vector<Convolution> stage;
    for (const int index : stage_layers()[s]) {
      const std::string name = "features." + std::to_string(index);
      const int64_t outputs = vgg16.dimension(name + ".weight", 0);
      stage.emplace_back(compute, vgg16, name, ConvolutionShape{outputs, inputs, 3, 1, 1, true});
      inputs = outputs;
    }
    stages_.push_back(std::move(stage));
    weights_.push_back(linear.load("lin" + std::to_string(s) + ".model.1.weight", {1, inputs, 1, 1}));
  }
}

std::vector<FeatureMap> Lpips::features(Compute& compute, const ImageF& image, LpipsInput input) const {
  std::vector<FeatureMap> out;
  FeatureMap x = normalised(image, input);
  for (size_t s = 0; s < stages_.size(); ++s) {
    if (s > 0) x = max_pool_2x2(compute, x);
    for (const Convolution& convolution : stages_[s]) x = convolution(compute, x, {false, Activation::kRelu});
    out.push_back(x);
    scale_to_unit_length(out.back());
  }
  return out;
}

double Lpips::distance(Compute& compute, const ImageF& a, const ImageF& b, LpipsInput input) const {
  if (a.width != b.width || a.height != b.height || a.channels != 3 || b.channels != 3 || a.width < kSmallest ||
      a.height < kSmallest) {
    throw_bad_input({}, "images", "LPIPS compares two RGB images of one size of at least 16 x 16");
  }
  const std::vector<FeatureMap> fa = features(compute, a, input), fb = features(compute, b, input);
  double total = 0;
  for (size_t s = 0; s < fa.size(); ++s) {
    const int64_t channels = fa[s].channels;
    double sum = 0;
    for (size_t i = 0; i < fa[s].data.size(); ++i) {
      const double d = double(fa[s].data[i]) - double(fb[s].data[i]);
      sum += double(weights_[s][i % size_t(channels)]) * d * d;
    }
    total += sum / double(fa[s].places());
  }
  return total;
}

}  // namespace aligngs::nn
