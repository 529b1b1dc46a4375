#include "scene/corners.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr double kReferencePixels = 320.0 * 240;
constexpr int kWindow = 2;  // pixels to each side over which gradients are summed
constexpr int kBorder = kWindow + 1;

float strength_at(const ImageF& luma, int x, int y) {
  float xx = 0, xy = 0, yy = 0;
  for (int v = y - kWindow; v <= y + kWindow; ++v) {
    for (int u = x - kWindow; u <= x + kWindow; ++u) {
      const float gx = luma.at(u + 1, v) - luma.at(u - 1, v), gy = luma.at(u, v + 1) - luma.at(u, v - 1);
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  }
  return 0.5f * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy));
}

}  // namespace

double relative_size(const ImageF& luma) { return static_cast<double>(luma.pixels()) / kReferencePixels; }

ImageF luma_of(const ImageF& color) {
  ImageF luma(color.width, color.height, 1);
  for (size_t i = 0; i < color.pixels(); ++i) {
    const float* c = &color.data[i * static_cast<size_t>(color.channels)];
    luma.data[i] = color.channels < 3 ? c[0] : 0.299f * c[0] + 0.587f * c[1] + 0.114f * c[2];
  }
  return luma;
}

std::vector<Corner> find_corners(const ImageF& luma, const ImageF& mask, const CornerSettings& settings) {
  std::vector<Corner> all;
  float strongest = 0;
  for (int y = kBorder; y < luma.height - kBorder; ++y) {
    for (int x = kBorder; x < luma.width - kBorder; ++x) {
      if (!mask.empty() && mask.at(x, y) <= 0) continue;
      all.push_back({strength_at(luma, x, y), x, y});
      strongest = std::max(strongest, all.back().strength);
    }
  }
  const float least = std::max(static_cast<float>(settings.quality) * strongest, 1e-6f);
  all.erase(std::remove_if(all.begin(), all.end(), [least](const Corner& c) { return !(c.strength > least); }),
            all.end());
  std::sort(all.begin(), all.end(), [](const Corner& a, const Corner& b) {
    return a.strength != b.strength ? a.strength > b.strength : a.y != b.y ? a.y < b.y : a.x < b.x;
  });
  const size_t most = static_cast<size_t>(std::max(0, settings.per_view));
  const int spacing = std::max(1, settings.spacing);
  Image<uint8_t> taken(luma.width, luma.height, 1);
  std::vector<Corner> kept;
  for (const Corner& c : all) {
    if (kept.size() >= most) break;
    if (taken.at(c.x, c.y)) continue;
    kept.push_back(c);
    for (int y = std::max(0, c.y - spacing); y <= std::min(luma.height - 1, c.y + spacing); ++y) {
      for (int x = std::max(0, c.x - spacing); x <= std::min(luma.width - 1, c.x + spacing); ++x) taken.at(x, y) = 1;
    }
  }
  return kept;
}

}  // namespace aligngs
