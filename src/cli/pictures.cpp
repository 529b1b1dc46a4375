#include "cli/pictures.h"

#include <algorithm>
#include <cmath>

#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

uint8_t to_byte(float v) { return static_cast<uint8_t>(std::lround(std::clamp(v, 0.f, 1.f) * 255)); }

}  // namespace

void ramp_color(float t, uint8_t rgb[3]) {
  // Piecewise linear through dark blue, cyan, green, yellow, red: equal steps stay tellable apart.
  static constexpr float kStops[5][3] = {{0.10f, 0.13f, 0.45f},
                                         {0.10f, 0.60f, 0.80f},
                                         {0.25f, 0.75f, 0.35f},
                                         {0.98f, 0.85f, 0.25f},
                                         {0.80f, 0.15f, 0.12f}};
  const float x = std::clamp(t, 0.f, 1.f) * 4;
  const int i = std::min(3, static_cast<int>(x));
  for (int c = 0; c < 3; ++c) rgb[c] = to_byte(kStops[i][c] + (x - i) * (kStops[i + 1][c] - kStops[i][c]));
}

DepthRange depth_range(const ImageF& depth) {
  std::vector<float> values;
  for (const float z : depth.data) {
    if (z > 0 && std::isfinite(z)) values.push_back(z);
  }
  if (values.empty()) return {};
  const auto quantile = [&](size_t percent) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * percent / 100);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  DepthRange range{quantile(2), quantile(98)};
  if (!(range.high > range.low)) range.high = range.low * 1.01f;
  return range;
}

Image<uint8_t> depth_picture(const ImageF& depth, float low, float high) {
  Image<uint8_t> out(depth.width, depth.height, 3, 0);
  for (size_t i = 0; i < depth.pixels(); ++i) {
    const float z = depth.data[i];
    if (z > 0 && std::isfinite(z)) ramp_color(1 - (z - low) / (high - low), &out.data[3 * i]);
  }
  return out;
}

Image<uint8_t> normal_picture(const ImageF& normal) {
  Image<uint8_t> out(normal.width, normal.height, 3, 0);
  for (size_t i = 0; i < normal.pixels(); ++i) {
    const float* n = &normal.data[3 * i];
    if (n[0] == 0 && n[1] == 0 && n[2] == 0) continue;
    out.data[3 * i] = to_byte(0.5f + 0.5f * n[0]);
    out.data[3 * i + 1] = to_byte(0.5f - 0.5f * n[1]);  // the camera's y axis points down
    out.data[3 * i + 2] = to_byte(0.5f - 0.5f * n[2]);  // and its z axis away
  }
  return out;
}

Image<uint8_t> label_picture(const Image<uint16_t>& labels, const LabelSet& set) {
  Image<uint8_t> out(labels.width, labels.height, 3, 0);
  for (size_t i = 0; i < labels.pixels(); ++i) {
    if (labels.data[i] >= set.classes.size()) continue;
    for (int c = 0; c < 3; ++c) out.data[3 * i + c] = set.classes[labels.data[i]].color[c];
  }
  return out;
}

Image<uint8_t> error_picture(const ImageF& render, const ImageF& truth) {
  constexpr float kWhite = 0.25f;
  Image<uint8_t> out(render.width, render.height, 3, 0);
  for (size_t i = 0; i < render.pixels(); ++i) {
    float sum = 0;
    for (int c = 0; c < 3; ++c) sum += std::fabs(std::clamp(render.data[3 * i + c], 0.f, 1.f) - truth.data[3 * i + c]);
    for (int c = 0; c < 3; ++c) out.data[3 * i + c] = to_byte(sum / 3 / kWhite);
  }
  return out;
}

}  // namespace aligngs
