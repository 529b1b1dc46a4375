#include "edit/recolor.h"

#include <algorithm>
#include <cmath>

#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr float kLuma[3] = {0.2126f, 0.7152f, 0.0722f};  // Rec. 709

float luma(float r, float g, float b) { return kLuma[0] * r + kLuma[1] * g + kLuma[2] * b; }

uint8_t to_byte(float v) { return static_cast<uint8_t>(std::lround(255 * std::clamp(v, 0.f, 1.f))); }

}  // namespace

std::optional<float> mean_luma(const GaussianModel& model, const std::vector<uint8_t>& selected) {
  double sum = 0, weight = 0;
  for (size_t i = 0; i < model.size(); ++i) {
    if (!selected[i]) continue;
    const Vec3f c = base_color_of(model, i);
    const double opacity = opacity_of(model, i);
    sum += opacity * luma(c.x, c.y, c.z);
    weight += opacity;
  }
  if (!(weight > 0)) return std::nullopt;
  return static_cast<float>(std::max(sum / weight, kDarkestMean));
}

void recolor_gaussians(GaussianModel& model, const std::vector<uint8_t>& selected,
                       const std::array<uint8_t, 3>& color) {
  if (const auto mean = mean_luma(model, selected)) recolor_gaussians(model, selected, color, *mean);
}

void recolor_gaussians(GaussianModel& model, const std::vector<uint8_t>& selected, const std::array<uint8_t, 3>& color,
                       float mean) {
  for (size_t i = 0; i < model.size(); ++i) {
    if (!selected[i]) continue;
    float* sh = &model.sh[size_t(3) * kShCoefficients * i];
    const Vec3f base = base_color_of(model, i);
    const float y = luma(base.x, base.y, base.z) / mean;
    for (int k = 1; k < kShCoefficients; ++k) {
      const float shade = luma(sh[3 * k], sh[3 * k + 1], sh[3 * k + 2]) / mean;
      for (int c = 0; c < 3; ++c) sh[3 * k + c] = shade * static_cast<float>(color[c]) / 255;
    }
    for (int c = 0; c < 3; ++c) sh[c] = (y * static_cast<float>(color[c]) / 255 - 0.5f) / static_cast<float>(kSh0);
  }
}

void recolor_vertices(TriangleMesh& mesh, const std::vector<uint8_t>& selected, const std::array<uint8_t, 3>& color) {
  if (mesh.colors.empty()) return;
  double sum = 0;
  size_t count = 0;
  const auto shade_of = [&](size_t v) {
    const auto& c = mesh.colors[v];
    return luma(c[0], c[1], c[2]) / 255;
  };
  for (size_t v = 0; v < mesh.colors.size(); ++v) {
    if (!selected[v]) continue;
    sum += shade_of(v);
    ++count;
  }
  if (count == 0) return;
  const float mean = static_cast<float>(std::max(sum / static_cast<double>(count), kDarkestMean));
  for (size_t v = 0; v < mesh.colors.size(); ++v) {
    if (!selected[v]) continue;
    const float y = shade_of(v) / mean;
    for (size_t c = 0; c < 3; ++c) mesh.colors[v][c] = to_byte(y * static_cast<float>(color[c]) / 255);
  }
}

void highlight_gaussians(GaussianModel& model, const std::vector<uint8_t>& selected,
                         const std::array<uint8_t, 3>& color) {
  for (size_t i = 0; i < model.size(); ++i) {
    if (!selected[i]) continue;
    float* sh = &model.sh[size_t(3) * kShCoefficients * i];
    for (int k = 0; k < 3 * kShCoefficients; ++k) sh[k] *= 1 - kHighlightShare;
    for (int c = 0; c < 3; ++c) {
      sh[c] += kHighlightShare * (static_cast<float>(color[c]) / 255 - 0.5f) / static_cast<float>(kSh0);
    }
  }
}

void highlight_vertices(TriangleMesh& mesh, const std::vector<uint8_t>& selected, const std::array<uint8_t, 3>& color) {
  for (size_t v = 0; v < mesh.colors.size(); ++v) {
    if (!selected[v]) continue;
    for (size_t c = 0; c < 3; ++c) {
      const float mixed = (1 - kHighlightShare) * mesh.colors[v][c] + kHighlightShare * color[c];
      mesh.colors[v][c] = to_byte(mixed / 255);
    }
  }
}

}  // namespace aligngs
