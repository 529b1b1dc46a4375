#include "nn/da3/reference_view.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace aligngs::nn {
namespace {

/// Similarity to the others, length, and variance of the unit vector, per view.
std::array<std::vector<double>, 3> measures_of(const Matrix& tokens) {
  const auto views = size_t(tokens.rows), channels = size_t(tokens.columns);
  std::array<std::vector<double>, 3> out;
  std::vector<std::vector<double>> units;
  for (size_t s = 0; s < views; ++s) {
    const float* const token = tokens.row(int64_t(s));
    std::vector<double> unit(token, token + channels);
    double squares = 0, mean = 0, variance = 0;
    for (const double v : unit) squares += v * v;
    const double length = std::sqrt(squares);
    for (double& v : unit) mean += (v /= std::max(length, 1e-300)) / double(channels);
    for (const double v : unit) variance += (v - mean) * (v - mean);
    out[1].push_back(length);
    out[2].push_back(variance / std::max(double(channels) - 1, 1.0));
    units.push_back(std::move(unit));
  }
  for (size_t s = 0; s < views; ++s) {
    double sum = 0;
    for (size_t t = 0; t < views; ++t) {
      for (size_t c = 0; t != s && c < channels; ++c) sum += units[s][c] * units[t][c];
    }
    out[0].push_back(sum / std::max(double(views) - 1, 1.0));
  }
  return out;
}

}  // namespace

Da3Reference choose_reference_view(const Matrix& class_tokens, Da3ReferenceRule rule) {
  Da3Reference chosen;
  if (rule == Da3ReferenceRule::kMiddle) chosen.view = class_tokens.rows / 2;
  if (rule != Da3ReferenceRule::kSaddleBalanced) return chosen;
  constexpr double kHalf = 0.5, kLeastRange = 1e-8;
  std::vector<double> scores(size_t(class_tokens.rows));
  for (const std::vector<double>& measure : measures_of(class_tokens)) {
    const auto [low, high] = std::minmax_element(measure.begin(), measure.end());
    for (size_t s = 0; s < scores.size(); ++s)
      scores[s] += std::abs((measure[s] - *low) / (*high - *low + kLeastRange) - kHalf);
  }
  chosen.view = int64_t(std::min_element(scores.begin(), scores.end()) - scores.begin());
  chosen.scores.assign(scores.begin(), scores.end());
  return chosen;
}

}  // namespace aligngs::nn
