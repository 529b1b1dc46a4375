#include "refine/push_pull.h"

#include <algorithm>

namespace aligngs {
namespace {

struct ColorLevel {
  ImageF color, weight;
};

/// Each pixel is the weighted mean of the four that it covers.
ColorLevel halved(const ColorLevel& fine) {
  const int width = (fine.weight.width + 1) / 2, height = (fine.weight.height + 1) / 2;
  ColorLevel out{ImageF(width, height, 3), ImageF(width, height, 1)};
  for (int y = 0; y < fine.weight.height; ++y) {
    for (int x = 0; x < fine.weight.width; ++x) {
      const float w = fine.weight.at(x, y);
      out.weight.at(x / 2, y / 2) += w;
      for (int c = 0; c < 3; ++c) out.color.at(x / 2, y / 2, c) += w * fine.color.at(x, y, c);
    }
  }
  for (size_t i = 0; i < out.weight.data.size(); ++i) {
    float& w = out.weight.data[i];
    for (size_t c = 0; w > 0 && c < 3; ++c) out.color.data[3 * i + c] /= w;
    w = std::min(w, 1.0f);
  }
  return out;
}

/// Bilinear between the centres of the coarse map's pixels.
float coarse_color(const ImageF& coarse, int x, int y, int c) {
  const float u = std::clamp(0.5f * static_cast<float>(x) - 0.25f, 0.0f, static_cast<float>(coarse.width - 1));
  const float v = std::clamp(0.5f * static_cast<float>(y) - 0.25f, 0.0f, static_cast<float>(coarse.height - 1));
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const int i1 = std::min(i + 1, coarse.width - 1), j1 = std::min(j + 1, coarse.height - 1);
  const float a = u - static_cast<float>(i), b = v - static_cast<float>(j);
  return (1 - b) * ((1 - a) * coarse.at(i, j, c) + a * coarse.at(i1, j, c)) +
         b * ((1 - a) * coarse.at(i, j1, c) + a * coarse.at(i1, j1, c));
}

void fill_from(const ImageF& coarse, ColorLevel& fine) {
  for (int y = 0; y < fine.weight.height; ++y) {
    for (int x = 0; x < fine.weight.width; ++x) {
      const float w = fine.weight.at(x, y);
      for (int c = 0; w < 1 && c < 3; ++c) {
        float& color = fine.color.at(x, y, c);
        color = w * color + (1 - w) * coarse_color(coarse, x, y, c);
      }
    }
  }
}

}  // namespace

ImageF push_pull(const ImageF& color, const ImageF& weight) {
  if (weight.empty()) return color;
  std::vector<ColorLevel> levels = {{color, weight}};
  for (size_t i = 0; i < weight.data.size(); ++i) {
    for (size_t c = 0; weight.data[i] <= 0 && c < 3; ++c) levels[0].color.data[3 * i + c] = 0;
  }
  while (levels.back().weight.width > 1 || levels.back().weight.height > 1) levels.push_back(halved(levels.back()));
  for (size_t l = levels.size() - 1; l > 0; --l) fill_from(levels[l].color, levels[l - 1]);
  return levels[0].color;
}

}  // namespace aligngs
