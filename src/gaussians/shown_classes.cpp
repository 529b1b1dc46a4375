#include "gaussians/shown_classes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aligngs {
namespace {

constexpr float kLeastProbability = 1e-6f;  // the class of a solid pixel has at least 0.5 / 150

}  // namespace

std::vector<uint16_t> keep_shown_classes(GaussianModel& model) {
  const size_t channels = static_cast<size_t>(model.semantic_channels), rows = model.size();
  std::vector<uint16_t> classes;
  if (channels == 0) return classes;
  std::vector<uint8_t> shown(channels, 0);
  shown[0] = 1;
  for (size_t i = 0; i < rows; ++i) {
    const float* row = &model.semantics[i * channels];
    const auto [low, high] = std::minmax_element(row, row + channels);
    if (*low == *high) continue;
    // A probability is at most exp(v - high).
    const float least = *high + std::log(kLeastProbability);
    for (size_t c = 0; c < channels; ++c) shown[c] |= static_cast<uint8_t>(row[c] > least);
  }
  for (size_t c = 0; c < channels; ++c) {
    if (shown[c] != 0) classes.push_back(static_cast<uint16_t>(c));
  }
  std::vector<float> kept;
  kept.reserve(rows * classes.size());
  for (size_t i = 0; i < rows; ++i) {
    for (const uint16_t c : classes) kept.push_back(model.semantics[i * channels + c]);
  }
  model.semantics = std::move(kept);
  model.semantic_channels = static_cast<int>(classes.size());
  return classes;
}

}  // namespace aligngs
