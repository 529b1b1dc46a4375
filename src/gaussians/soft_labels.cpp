#include "gaussians/soft_labels.h"

#include <algorithm>
#include <cmath>

#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr size_t kSoftLabelGrain = 512;  // Gaussians per chunk

void top_of_row(const float* s, size_t channels, std::vector<uint16_t>& order, uint16_t* label, float* probability) {
  std::fill_n(label, SoftLabels::kTop, kNoLabel);
  std::fill_n(probability, SoftLabels::kTop, 0.f);
  const auto [least, most] = std::minmax_element(s, s + channels);
  if (*least == *most || !std::isfinite(*most)) return;
  double sum = 0, power = 1;
  float last = *most;  // most classes of a row have the same value, that of no vote
  for (size_t c = 0; c < channels; ++c) {
    if (s[c] != last) power = std::exp(static_cast<double>(s[c]) - *most);
    last = s[c];
    sum += power;
  }
  const size_t kept = std::min(SoftLabels::kTop, channels);
  for (size_t c = 0; c < channels; ++c) order[c] = static_cast<uint16_t>(c);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(),
                    [&](uint16_t a, uint16_t b) { return s[a] > s[b] || (s[a] == s[b] && a < b); });
  for (size_t k = 0; k < kept; ++k) {
    label[k] = order[k];
    probability[k] = static_cast<float>(std::exp(static_cast<double>(s[order[k]]) - *most) / sum);
  }
}

}  // namespace

float SoftLabels::of(size_t gaussian, int wanted) const {
  for (size_t k = kTop * gaussian; k < kTop * (gaussian + 1); ++k) {
    if (label[k] == wanted) return probability[k];
  }
  return 0;
}

SoftLabels soft_labels(const GaussianModel& model, ThreadPool& pool) {
  const size_t n = model.size(), channels = static_cast<size_t>(model.semantic_channels);
  SoftLabels soft;
  soft.label.assign(n * SoftLabels::kTop, kNoLabel);
  soft.probability.assign(n * SoftLabels::kTop, 0.f);
  if (channels == 0) return soft;
  pool.parallel_for(n, kSoftLabelGrain, [&](size_t begin, size_t end, int) {
    std::vector<uint16_t> order(channels);
    for (size_t i = begin; i < end; ++i) {
      const size_t row = SoftLabels::kTop * i;
      top_of_row(&model.semantics[i * channels], channels, order, &soft.label[row], &soft.probability[row]);
    }
  });
  return soft;
}

GaussianLabels best_labels(const SoftLabels& soft, const LabelSet& labels) {
  GaussianLabels out;
  out.label_set = labels.name;
  out.instance.assign(soft.size(), 0);
  for (size_t i = 0; i < soft.size(); ++i) {
    out.label.push_back(soft.label[SoftLabels::kTop * i]);
    out.confidence.push_back(
        static_cast<uint8_t>(std::lround(255 * std::clamp(soft.probability[SoftLabels::kTop * i], 0.f, 1.f))));
  }
  return out;
}

std::vector<Vec3f> positions_of(const GaussianModel& model) {
  std::vector<Vec3f> out(model.size());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = {model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
  return out;
}

double extent_of(const GaussianModel& model) {
  const size_t n = model.size();
  double squared = 0;
  std::vector<float> axis(n);
  for (size_t a = 0; a < 3 && n > 0; ++a) {
    for (size_t i = 0; i < n; ++i) axis[i] = model.positions[3 * i + a];
    std::sort(axis.begin(), axis.end());
    const double side = static_cast<double>(axis[(n - 1) * 95 / 100]) - axis[(n - 1) * 5 / 100];
    squared += side * side;
  }
  return squared > 0 ? 0.5 * std::sqrt(squared) : 1;
}

float opacity_of(const GaussianModel& model, size_t i) { return 1.f / (1.f + std::exp(-model.opacity_logits[i])); }

Vec3f base_color_of(const GaussianModel& model, size_t i) {
  const float* sh = &model.sh[size_t(3) * kShCoefficients * i];
  const float c = static_cast<float>(kSh0);
  return {0.5f + c * sh[0], 0.5f + c * sh[1], 0.5f + c * sh[2]};
}

}  // namespace aligngs
