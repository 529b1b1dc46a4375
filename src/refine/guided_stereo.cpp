#include "refine/guided_stereo.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/angles.h"
#include "core/disjoint_sets.h"
#include "core/median.h"
#include "refine/view_overlap.h"

namespace aligngs {
namespace {

/// A view's own measurement before others were asked.
struct Measurement {
  ImageF log_factor, certainty;
};

double median_depth(const ImageF& depth) {
  std::vector<float> values;
  for (const float z : depth.data) {
    if (z > 0 && std::isfinite(z)) values.push_back(z);
  }
  return median_of(std::move(values));
}

/// Offset of the minimum of a parabola through three equidistant values, in [-0.5, 0.5].
double parabola_offset(double left, double middle, double right) {
  const double curvature = left - 2 * middle + right;
  return curvature > 0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0;
}

/// How sure the winner is: its correlation, and how exactly the rise of the cost around it tells the depth.
double certainty_of(const float* cost, int best, const StereoSettings& settings) {
  constexpr int kAway = 4;  // hypotheses; nearer ones differ by less than the noise
  // the truth may lie outside of what was tried
  if (best < kAway || best + kAway >= settings.sweep.hypotheses) return 0;
  const double score = 1 - cost[best];
  if (score <= settings.least_score) return 0;
  const double rise = 0.5 * (cost[best - kAway] + cost[best + kAway]) - cost[best];
  if (rise <= 0) return 0;
  const double step = settings.sweep.log_factor(best + kAway) - settings.sweep.log_factor(best);
  const double variance = (settings.cost_noise + cost[best]) * step * step / rise;  // cost = least + rise (x / step)^2
  return (score - settings.least_score) / (1 - settings.least_score) /
         (1 + variance / (settings.sigma * settings.sigma));
}

Measurement measure(const MatchView& view, const std::vector<const MatchView*>& others,
                    const StereoSettings& settings) {
  Measurement out{ImageF(view.luma.width, view.luma.height, 1), ImageF(view.luma.width, view.luma.height, 1)};
  if (view.depth.empty() || others.empty()) return out;
  CostVolume volume = sweep_prior_depth(view, others, settings.sweep);
  const CostVolume raw = volume;
  aggregate_costs(volume, view.depth, settings.choice, view.luma);
  for (int y = 0; y < volume.height; ++y) {
    for (int x = 0; x < volume.width; ++x) {
      const size_t i = static_cast<size_t>(y) * volume.width + x;
      if (!volume.known[i]) continue;
      const float* sums = volume.at(x, y);
      const int best = static_cast<int>(std::min_element(sums, sums + volume.hypotheses) - sums);
      const double certainty = certainty_of(raw.at(x, y), best, settings);
      if (certainty <= 0) continue;
      const double offset = parabola_offset(sums[best - 1], sums[best], sums[best + 1]);
      out.log_factor.data[i] = static_cast<float>(settings.sweep.log_factor(best + offset));
      out.certainty.data[i] = static_cast<float>(certainty);
    }
  }
  return out;
}

/// Certainties of pixels that no other photo's measurement confirms become 0.
ImageF confirmed(const MatchView& view, const Measurement& own, const std::vector<const MatchView*>& others,
                 const std::vector<const Measurement*>& theirs, const StereoSettings& settings) {
  ImageF certainty = own.certainty;
  std::vector<Rigidd> to_other;
  for (const MatchView* other : others)
    to_other.push_back(other->camera.world_to_camera * view.camera.world_to_camera.inverse());
  for (int y = 0; y < certainty.height; ++y) {
    for (int x = 0; x < certainty.width; ++x) {
      float& c = certainty.at(x, y);
      if (c <= 0) continue;
      const Vec3d point = view.camera.ray(x + 0.5, y + 0.5) *
                          (view.depth.at(x, y) * std::exp(static_cast<double>(own.log_factor.at(x, y))));
      bool agrees = false;
      for (size_t k = 0; k < others.size() && !agrees; ++k) {
        const Vec3d p = to_other[k] * point;
        if (!(p.z > 0)) continue;
        const Vec2d q = others[k]->camera.project(p);
        if (!others[k]->camera.contains(q)) continue;
        const int u = static_cast<int>(q.x), v = static_cast<int>(q.y);
        if (theirs[k]->certainty.at(u, v) <= 0) continue;
        const double z = others[k]->depth.at(u, v) * std::exp(static_cast<double>(theirs[k]->log_factor.at(u, v)));
        agrees = std::abs(z - p.z) <= settings.agreement * p.z;
      }
      if (!agrees) c = 0;
    }
  }
  return certainty;
}

/// Certainties of confirmed patches that are smaller than settings.least_patch become 0. Neighbours whose depths agree
/// belong together.
void drop_small_patches(const MatchView& view, const ImageF& log_factor, const StereoSettings& settings,
                        ImageF& certainty) {
  const int width = certainty.width, height = certainty.height;
  DisjointSets patches(certainty.pixels());
  const auto join = [&](size_t i, size_t j) {
    if (certainty.data[i] <= 0 || certainty.data[j] <= 0) return;
    const float step = std::log(view.depth.data[i] / view.depth.data[j]) + log_factor.data[i] - log_factor.data[j];
    if (std::abs(step) <= settings.agreement) patches.unite(static_cast<uint32_t>(i), static_cast<uint32_t>(j));
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      if (x + 1 < width) join(i, i + 1);
      if (y + 1 < height) join(i, i + static_cast<size_t>(width));
    }
  }
  std::vector<int> sizes(certainty.pixels(), 0);
  for (size_t i = 0; i < sizes.size(); ++i) ++sizes[patches.find(static_cast<uint32_t>(i))];
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[patches.find(static_cast<uint32_t>(i))] < settings.least_patch) certainty.data[i] = 0;
  }
}

}  // namespace

std::vector<std::vector<int>> stereo_partners(const std::vector<const MatchView*>& views,
                                              const StereoSettings& settings) {
  std::vector<std::vector<int>> partners(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    const double depth = median_depth(views[i]->depth);
    std::vector<std::pair<double, int>> ranked;
    for (size_t k = 0; k < views.size() && depth > 0; ++k) {
      if (k == i || views[k]->depth.empty()) continue;
      const double overlap = view_overlap(*views[i], *views[k], settings.largest_turn);
      if (overlap < settings.least_overlap) continue;
      const Vec3d apart = views[k]->camera.centre() - views[i]->camera.centre();
      const double angle = std::atan(std::sqrt(dot(apart, apart)) / depth) * kDegreesPerRadian;
      ranked.emplace_back(-overlap * std::min(1.0, angle / settings.good_angle), static_cast<int>(k));
    }
    std::sort(ranked.begin(), ranked.end());
    for (size_t r = 0; r < ranked.size() && r < static_cast<size_t>(settings.neighbours); ++r) {
      if (ranked[r].first < 0) partners[i].push_back(ranked[r].second);
    }
  }
  return partners;
}

std::vector<StereoResult> guided_stereo(const std::vector<const MatchView*>& views, const StereoSettings& settings,
                                        ThreadPool& pool, const std::function<void(double share)>& progress) {
  const std::vector<std::vector<int>> partners = stereo_partners(views, settings);
  const auto photos_of = [&](size_t i) {
    std::vector<const MatchView*> out;
    for (const int k : partners[i]) out.push_back(views[static_cast<size_t>(k)]);
    return out;
  };
  std::vector<Measurement> measurements(views.size());
  std::atomic<size_t> done{0};
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int worker) {
    for (size_t i = begin; i < end; ++i) {
      measurements[i] = measure(*views[i], photos_of(i), settings);
      const size_t ended = ++done;
      if (progress && worker == 0) progress(static_cast<double>(ended) / static_cast<double>(views.size()));
    }
  });
  std::vector<StereoResult> results(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      if (views[i]->depth.empty()) continue;
      std::vector<const Measurement*> theirs;
      for (const int k : partners[i]) theirs.push_back(&measurements[static_cast<size_t>(k)]);
      StereoResult& result = results[i];
      result.certainty = confirmed(*views[i], measurements[i], photos_of(i), theirs, settings);
      result.own_factor = measurements[i].log_factor;
      if (settings.least_patch > 1) drop_small_patches(*views[i], result.own_factor, settings, result.certainty);
      result.log_factor = spread_log_correction(views[i]->depth, measurements[i].log_factor, result.certainty,
                                                settings.spread, views[i]->luma);
      size_t with_depth = 0, sure = 0;
      for (size_t p = 0; p < result.certainty.pixels(); ++p) {
        with_depth += views[i]->depth.data[p] > 0;
        sure += result.certainty.data[p] > 0;
      }
      result.measured = with_depth == 0 ? 0 : static_cast<double>(sure) / static_cast<double>(with_depth);
    }
  });
  return results;
}

}  // namespace aligngs
