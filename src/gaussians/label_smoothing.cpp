#include "gaussians/label_smoothing.h"

#include <algorithm>
#include <cmath>

#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr size_t kSmoothingGrain = 512;  // Gaussians per chunk

/// Classes and their sums; reused from Gaussian to Gaussian without clearing all of it.
class Tally {
 public:
  explicit Tally(size_t classes) : sum_(classes, 0.0) {}
  void add(uint16_t label, double weight) {
    if (label >= sum_.size()) return;
    if (sum_[label] == 0) touched_.push_back(label);
    sum_[label] += weight;
  }
  /// Writes the best classes, divided by `total`, and forgets them.
  void take(double total, uint16_t* label, float* probability) {
    std::sort(touched_.begin(), touched_.end(),
              [&](uint16_t a, uint16_t b) { return sum_[a] > sum_[b] || (sum_[a] == sum_[b] && a < b); });
    for (size_t k = 0; k < SoftLabels::kTop; ++k) {
      const bool has = k < touched_.size() && total > 0 && sum_[touched_[k]] > 0;
      label[k] = has ? touched_[k] : kNoLabel;
      probability[k] = has ? static_cast<float>(sum_[touched_[k]] / total) : 0.f;
    }
    for (const uint16_t touched : touched_) sum_[touched] = 0;
    touched_.clear();
  }

 private:
  std::vector<double> sum_;
  std::vector<uint16_t> touched_;
};

}  // namespace

LabelSmoother::LabelSmoother(const GaussianModel& model, double extent, ThreadPool& pool,
                             const SmoothingOptions& options, const PlacedNeighbours& known)
    : options_(options),
      graph_(known.serves(model.positions, options.neighbours) ? known.graph
                                                               : std::make_shared<const NeighbourGraph>(neighbour_graph(
                                                                     positions_of(model), options.neighbours, pool))) {
  const size_t n = model.size(), k = graph_->k;
  opacity_.resize(n);
  weight_.assign(n * k, -1.0);
  if (k == 0) return;
  std::vector<Vec3f> colors(n);
  for (size_t i = 0; i < n; ++i) {
    colors[i] = base_color_of(model, i);
    opacity_[i] = opacity_of(model, i);
  }
  const size_t middle = std::min(k - 1, static_cast<size_t>(options.distance_quantile * static_cast<double>(k)));
  const double reach = options.reach * (extent > 0 ? extent : extent_of(model)),
               color_scale = -0.5 / (options.color_sigma * options.color_sigma);
  pool.parallel_for(n, kSmoothingGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const double bandwidth = std::min<double>(graph_->distance[k * i + middle], reach);
      const double distance_scale = bandwidth > 0 ? -0.5 / (bandwidth * bandwidth) : 0;
      for (size_t slot = k * i; slot < k * (i + 1); ++slot) {
        const double distance = graph_->distance[slot];
        if (!(distance <= reach)) break;
        const size_t j = graph_->index[slot];
        const Vec3f difference = colors[i] - colors[j];
        weight_[slot] =
            opacity_[j] * std::exp(distance * distance * distance_scale + dot(difference, difference) * color_scale);
      }
    }
  });
}

void LabelSmoother::smooth_once(SoftLabels& soft, ThreadPool& pool) const {
  const size_t n = soft.size(), k = graph_->k;
  uint16_t classes = 0;
  for (const uint16_t label : soft.label) classes = label == kNoLabel ? classes : std::max<uint16_t>(classes, label);
  SoftLabels next = soft;
  pool.parallel_for(n, kSmoothingGrain, [&](size_t begin, size_t end, int) {
    Tally tally(size_t(classes) + 1);
    for (size_t i = begin; i < end; ++i) {
      double total = 0;
      const auto add = [&](size_t j, double weight) {
        if (soft.label[SoftLabels::kTop * j] == kNoLabel) return;  // taught by nothing: has no say
        total += weight;
        for (size_t s = SoftLabels::kTop * j; s < SoftLabels::kTop * (j + 1) && soft.label[s] != kNoLabel; ++s) {
          tally.add(soft.label[s], weight * soft.probability[s]);
        }
      };
      add(i, options_.own_weight * opacity_[i]);
      for (size_t slot = k * i; slot < k * (i + 1) && weight_[slot] >= 0; ++slot)
        add(graph_->index[slot], weight_[slot]);
      tally.take(total, &next.label[SoftLabels::kTop * i], &next.probability[SoftLabels::kTop * i]);
    }
  });
  soft = std::move(next);
}

SoftLabels LabelSmoother::smoothed(const GaussianModel& model, ThreadPool& pool) const {
  SoftLabels soft = soft_labels(model, pool);
  for (int round = 0; round < options_.rounds && graph_->k > 0; ++round) smooth_once(soft, pool);
  return soft;
}

}  // namespace aligngs
