#include "metrics/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/median.h"
#include "metrics/point_index.h"
#include "metrics/undefined.h"

namespace aligngs {
namespace {

struct OneWay {
  double mean = kUndefined, median = kUndefined;
  std::vector<double> shares;  // within each threshold
  double normal_sum = 0;
  size_t normal_count = 0;
};

OneWay measure(const PointSet& from, const PointSet& to, const PointIndex& index, ThreadPool& pool,
               const std::vector<double>& thresholds, bool strict) {
  OneWay result;
  result.shares.assign(thresholds.size(), kUndefined);
  if (from.positions.empty()) return result;
  if (to.positions.empty()) {
    result.shares.assign(thresholds.size(), 0);  // nothing is near; how far is not defined
    return result;
  }
  const std::vector<Nearest> nearest = index.nearest(from.positions, pool);
  const bool with_normals = from.normals.size() == from.positions.size() && to.normals.size() == to.positions.size();
  std::vector<float> distances(nearest.size());
  double sum = 0;
  std::vector<size_t> within(thresholds.size());
  for (size_t i = 0; i < nearest.size(); ++i) {
    const double d = nearest[i].distance;
    distances[i] = nearest[i].distance;
    sum += d;
    for (size_t k = 0; k < thresholds.size(); ++k) within[k] += strict ? d < thresholds[k] : d <= thresholds[k];
    if (with_normals && nearest[i].index != Nearest::kNoPoint) {
      result.normal_sum += std::abs(dot(from.normals[i], to.normals[nearest[i].index]));
      ++result.normal_count;
    }
  }
  result.median = median_of(std::move(distances));
  result.mean = sum / static_cast<double>(nearest.size());
  for (size_t k = 0; k < thresholds.size(); ++k)
    result.shares[k] = static_cast<double>(within[k]) / static_cast<double>(nearest.size());
  return result;
}

/// NaN where there is no truth; without any predicted point recall and F are 0.
ThresholdScores scores_at(double threshold, double precision, double recall, bool predicted, bool truth) {
  ThresholdScores scores{threshold, precision, recall, kUndefined};
  if (!truth) {
    scores.precision = kUndefined;
    return scores;
  }
  const double p = predicted ? precision : 0;
  scores.fscore = p + recall > 0 ? 2 * p * recall / (p + recall) : 0;
  return scores;
}

}  // namespace

MeshScores compare_points(const PointSet& predicted, const PointSet& truth, ThreadPool& pool,
                          const DistanceOptions& options) {
  std::optional<PointIndex> predicted_index, truth_index;  // each is made by one thread
  pool.parallel_for(2, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i)
      i == 0 ? predicted_index.emplace(predicted.positions) : truth_index.emplace(truth.positions);
  });
  std::vector<double> thresholds = {options.threshold};
  thresholds.insert(thresholds.end(), options.finer.begin(), options.finer.end());
  const OneWay accuracy = measure(predicted, truth, *truth_index, pool, thresholds, options.strict);
  const OneWay completeness = measure(truth, predicted, *predicted_index, pool, thresholds, options.strict);
  MeshScores scores;
  scores.threshold = options.threshold;
  scores.predicted_points = predicted.positions.size();
  scores.truth_points = truth.positions.size();
  scores.accuracy = accuracy.mean;
  scores.accuracy_median = accuracy.median;
  scores.completeness = completeness.mean;
  scores.completeness_median = completeness.median;
  const size_t normals = accuracy.normal_count + completeness.normal_count;
  scores.normal_consistency =
      normals ? (accuracy.normal_sum + completeness.normal_sum) / static_cast<double>(normals) : kUndefined;
  for (size_t k = 0; k < thresholds.size(); ++k) {
    scores.finer.push_back(scores_at(thresholds[k], accuracy.shares[k], completeness.shares[k],
                                     !predicted.positions.empty(), !truth.positions.empty()));
  }
  scores.precision = scores.finer.front().precision;
  scores.recall = scores.finer.front().recall;
  scores.fscore = scores.finer.front().fscore;
  scores.finer.erase(scores.finer.begin());
  return scores;
}

}  // namespace aligngs
