#include "metrics/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/median.h"
#include "metrics/point_index.h"

namespace aligngs {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct OneWay {
  double mean = kNan, median = kNan, share = kNan;
  double normal_sum = 0;
  size_t normal_count = 0;
};

OneWay measure(const PointSet& from, const PointSet& to, const PointIndex& index, ThreadPool& pool,
               const DistanceOptions& options) {
  OneWay result;
  if (from.positions.empty()) return result;
  if (to.positions.empty()) {
    result.share = 0;  // nothing is near; how far is not defined
    return result;
  }
  const std::vector<Nearest> nearest = index.nearest(from.positions, pool);
  const bool with_normals = from.normals.size() == from.positions.size() && to.normals.size() == to.positions.size();
  std::vector<float> distances(nearest.size());
  double sum = 0;
  size_t within = 0;
  for (size_t i = 0; i < nearest.size(); ++i) {
    const double d = nearest[i].distance;
    distances[i] = nearest[i].distance;
    sum += d;
    within += options.strict ? d < options.threshold : d <= options.threshold;
    if (with_normals && nearest[i].index != Nearest::kNoPoint) {
      result.normal_sum += std::abs(dot(from.normals[i], to.normals[nearest[i].index]));
      ++result.normal_count;
    }
  }
  result.median = median_of(std::move(distances));
  result.mean = sum / static_cast<double>(nearest.size());
  result.share = static_cast<double>(within) / static_cast<double>(nearest.size());
  return result;
}

}  // namespace

MeshScores compare_points(const PointSet& predicted, const PointSet& truth, ThreadPool& pool,
                          const DistanceOptions& options) {
  std::optional<PointIndex> predicted_index, truth_index;  // each is made by one thread
  pool.parallel_for(2, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) i == 0 ? predicted_index.emplace(predicted.positions) : truth_index.emplace(truth.positions);
  });
  const OneWay accuracy = measure(predicted, truth, *truth_index, pool, options);
  const OneWay completeness = measure(truth, predicted, *predicted_index, pool, options);
  MeshScores scores;
  scores.threshold = options.threshold;
  scores.predicted_points = predicted.positions.size();
  scores.truth_points = truth.positions.size();
  scores.accuracy = accuracy.mean;
  scores.accuracy_median = accuracy.median;
  scores.precision = accuracy.share;
  scores.completeness = completeness.mean;
  scores.completeness_median = completeness.median;
  scores.recall = completeness.share;
  const size_t normals = accuracy.normal_count + completeness.normal_count;
  scores.normal_consistency =
      normals ? (accuracy.normal_sum + completeness.normal_sum) / static_cast<double>(normals) : kNan;
  if (truth.positions.empty()) {
    scores.precision = scores.fscore = kNan;
  } else {
    const double p = predicted.positions.empty() ? 0 : scores.precision, r = scores.recall;
    scores.fscore = p + r > 0 ? 2 * p * r / (p + r) : 0;
  }
  return scores;
}

}  // namespace aligngs
