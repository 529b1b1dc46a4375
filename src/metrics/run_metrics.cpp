#include "metrics/run_metrics.h"

#include <fmt/format.h>

#include <cmath>

namespace aligngs {
namespace {

/// Mean of the finite values.
class FiniteMean {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    sum_ += value;
    ++count_;
  }
  double value() const { return count_ ? sum_ / count_ : kUndefined; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

}  // namespace

std::string protocol_text(const MeshProtocolResult& result) {
  return fmt::format("{}, {}, alignment: {}", result.protocol, result.culling, result.alignment);
}

double mean_over_views(const std::vector<TestViewMetrics>& views, double TestViewMetrics::*figure,
                       std::optional<bool> extrapolating) {
  FiniteMean mean;
  for (const TestViewMetrics& view : views) {
    if (!extrapolating || view.extrapolates == *extrapolating) mean.add(view.*figure);
  }
  return mean.value();
}

double mean_over_views(const std::vector<TestViewMetrics>& views, double RefinedPoseMetrics::*figure) {
  FiniteMean mean;
  for (const TestViewMetrics& view : views) {
    if (view.pose_refined) mean.add((*view.pose_refined).*figure);
  }
  return mean.value();
}

}  // namespace aligngs
