#include "refine/label_paths.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace aligngs {
namespace {

bool same_class(const Image<uint16_t>& classes, int x, int y, int other_x, int other_y) {
  return classes.empty() || classes.at(x, y) == classes.at(other_x, other_y);
}

/// Adds to `sums` the costs of all paths that come from (x - dx, y - dy).
void add_paths(const ImageF& costs, const ImageF& luma, const Image<uint16_t>& classes,
               const LabelPathSettings& settings, int dx, int dy, ImageF& sums) {
  const int width = costs.width, height = costs.height, labels = costs.channels;
  const size_t row = static_cast<size_t>(width) * labels;
  std::vector<float> previous(row), current(row);
  for (int j = 0; j < height; ++j) {
    const int y = dy < 0 ? height - 1 - j : j;
    for (int i = 0; i < width; ++i) {
      const int x = dx < 0 ? width - 1 - i : i, from_x = x - dx, from_y = y - dy;
      const float* cost = costs.pixel(x, y);
      float* out = &current[static_cast<size_t>(x) * labels];
      if (from_x < 0 || from_x >= width || from_y < 0 || from_y >= height) {
        std::copy(cost, cost + labels, out);
      } else {
        const float* from = &(dy == 0 ? current : previous)[static_cast<size_t>(from_x) * labels];
        const double step = static_cast<double>(luma.at(x, y) - luma.at(from_x, from_y)) / settings.luma_edge;
        const float least = *std::min_element(from, from + labels),
                    change = static_cast<float>(settings.change / (1 + step * step)) *
                             (same_class(classes, x, y, from_x, from_y) ? 1 : settings.class_edge);
        for (int k = 0; k < labels; ++k) out[k] = cost[k] + std::min(from[k] - least, change);
      }
      float* sum = sums.pixel(x, y);
      for (int k = 0; k < labels; ++k) sum[k] += out[k];
    }
    std::swap(previous, current);
  }
}

}  // namespace

Image<uint8_t> label_by_paths(const ImageF& costs, const ImageF& luma, const Image<uint16_t>& classes,
                              const LabelPathSettings& settings) {
  ImageF sums(costs.width, costs.height, costs.channels);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx != 0 || dy != 0) add_paths(costs, luma, classes, settings, dx, dy, sums);
    }
  }
  Image<uint8_t> labels(costs.width, costs.height, 1);
  for (int y = 0; y < costs.height; ++y) {
    for (int x = 0; x < costs.width; ++x) {
      const float* sum = sums.pixel(x, y);
      labels.at(x, y) = static_cast<uint8_t>(std::min_element(sum, sum + costs.channels) - sum);
    }
  }
  return labels;
}

}  // namespace aligngs
