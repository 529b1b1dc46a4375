#include "refine/semi_global.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/always_inline.h"
#include "core/target_clones.h"

namespace aligngs {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

struct Penalty {
  float small, large;
};

ALIGNGS_ALWAYS_INLINE float least_of(const float* from, size_t count) {
  constexpr size_t kSide = 16;  // side by side: the least of all is the same in any order
  if (count < kSide) return *std::min_element(from, from + count);
  float least[kSide];
  std::copy_n(from, kSide, least);
  for (size_t h = kSide; h + kSide <= count; h += kSide) {
    for (size_t k = 0; k < kSide; ++k) least[k] = from[h + k] < least[k] ? from[h + k] : least[k];
  }
  const float* const last = from + (count - kSide);
  for (size_t k = 0; k < kSide; ++k) least[k] = last[k] < least[k] ? last[k] : least[k];
  for (size_t half = kSide / 2; half > 0; half /= 2) {
    for (size_t k = 0; k < half; ++k) least[k] = least[k + half] < least[k] ? least[k + half] : least[k];
  }
  return least[0];
}

/// The path's costs at a pixel from those at the one before. `before` and `out` have kNever on both sides.
ALIGNGS_TARGET_CLONES
void step(const float* before, const float* costs, size_t count, const Penalty& penalty, float* out_costs,
          float* sums) {
  const float* __restrict from = before;
  const float* __restrict cost = costs;
  float* __restrict out = out_costs;
  float* __restrict sum = sums;
  const float least = least_of(from, count);
  const float near = penalty.small, any = least + penalty.large;
  for (size_t h = 0; h < count; ++h) {
    const float lower = from[static_cast<ptrdiff_t>(h) - 1] + near, upper = from[h + 1] + near;
    float best = from[h] < any ? from[h] : any;
    best = lower < best ? lower : best;
    best = upper < best ? upper : best;
    out[h] = cost[h] + best - least;  // without `least` the sums would grow along the path
    sum[h] += out[h];
  }
}

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
    const size_t each = n_ + 2;  // a hypothesis that never wins on both sides
    std::vector<float> previous(static_cast<size_t>(width) * each, kNever), current(previous);
    const int first_x = dx < 0 ? width - 1 : 0, step_x = dx < 0 ? -1 : 1;
    const int first_y = dy < 0 ? height - 1 : 0, step_y = dy < 0 ? -1 : 1;
    for (int j = 0, y = first_y; j < height; ++j, y += step_y) {
      for (int i = 0, x = first_x; i < width; ++i, x += step_x) {
        const int from_x = x - dx, from_y = y - dy;
        float* out = &current[static_cast<size_t>(x) * each + 1];
        const float* cost = volume_.at(x, y);
        float* sum = &sums_[(static_cast<size_t>(y) * width + x) * n_];
        if (from_x < 0 || from_x >= width || from_y < 0 || from_y >= height) {
          std::copy(cost, cost + n_, out);
          for (size_t h = 0; h < n_; ++h) sum[h] += out[h];
        } else {
          const std::vector<float>& source = dy == 0 ? current : previous;
          const float weight = edge(x, y, from_x, from_y) ? settings_.across_edge : 1.0f;
          step(&source[static_cast<size_t>(from_x) * each + 1], cost, n_,
               {weight * settings_.small_step, weight * large_step(x, y, from_x, from_y)}, out, sum);
        }
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
