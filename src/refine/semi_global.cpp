#include "refine/semi_global.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

class Paths {
 public:
  Paths(const CostVolume& volume, const ImageF& depth, const SemiGlobalSettings& settings, const ImageF& luma)
      : volume_(volume),
        depth_(depth),
        settings_(settings),
        luma_(settings.luma_edge > 0 && !luma.empty() ? &luma : nullptr),
        n_(static_cast<size_t>(volume.hypotheses)),
        sums_(volume.cost.size(), 0.0f) {}

  /// Adds the costs of all paths that come from (x - dx, y - dy).
  void add(int dx, int dy) {
    const int width = volume_.width, height = volume_.height;
    const size_t row = static_cast<size_t>(width) * n_;
    std::vector<float> previous(row), current(row);
    const int first_x = dx < 0 ? width - 1 : 0, step_x = dx < 0 ? -1 : 1;
    const int first_y = dy < 0 ? height - 1 : 0, step_y = dy < 0 ? -1 : 1;
    for (int j = 0, y = first_y; j < height; ++j, y += step_y) {
      for (int i = 0, x = first_x; i < width; ++i, x += step_x) {
        const int from_x = x - dx, from_y = y - dy;
        float* out = &current[static_cast<size_t>(x) * n_];
        const float* cost = volume_.at(x, y);
        if (from_x < 0 || from_x >= width || from_y < 0 || from_y >= height) {
          std::copy(cost, cost + n_, out);
        } else {
          const std::vector<float>& source = dy == 0 ? current : previous;
          const float weight = edge(x, y, from_x, from_y) ? settings_.across_edge : 1.0f;
          step(&source[static_cast<size_t>(from_x) * n_], cost,
               {weight * settings_.small_step, weight * large_step(x, y, from_x, from_y)}, out);
        }
        float* sum = &sums_[(static_cast<size_t>(y) * width + x) * n_];
        for (size_t h = 0; h < n_; ++h) sum[h] += out[h];
      }
      std::swap(previous, current);
    }
  }

  std::vector<float>& sums() { return sums_; }

 private:
  bool edge(int x, int y, int from_x, int from_y) const {
    const float a = depth_.at(x, y), b = depth_.at(from_x, from_y);
    return !(a > 0 && b > 0) || std::abs(a - b) > settings_.depth_jump * std::min(a, b);
  }

  float large_step(int x, int y, int from_x, int from_y) const {
    if (!luma_) return settings_.large_step;
    const double difference = std::abs(static_cast<double>(luma_->at(x, y) - luma_->at(from_x, from_y)));
    return std::max(settings_.small_step,
                    static_cast<float>(settings_.large_step / (1 + difference / settings_.luma_edge)));
  }

  struct Penalty {
    float small, large;
  };

  void step(const float* from, const float* cost, const Penalty& penalty, float* out) const {
    const float least = *std::min_element(from, from + n_);
    const float near = penalty.small, any = least + penalty.large;
    for (size_t h = 0; h < n_; ++h) {
      float best = std::min(from[h], any);
      if (h > 0) best = std::min(best, from[h - 1] + near);
      if (h + 1 < n_) best = std::min(best, from[h + 1] + near);
      out[h] = cost[h] + best - least;  // without `least` the sums would grow along the path
    }
  }

  const CostVolume& volume_;
  const ImageF& depth_;
  const SemiGlobalSettings& settings_;
  const ImageF* luma_;  ///< nullptr: not looked at
  size_t n_;
  std::vector<float> sums_;
};

}  // namespace

void aggregate_costs(CostVolume& volume, const ImageF& depth, const SemiGlobalSettings& settings, const ImageF& luma) {
  Paths paths(volume, depth, settings, luma);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx != 0 || dy != 0) paths.add(dx, dy);
    }
  }
  volume.cost = std::move(paths.sums());
}

}  // namespace aligngs
