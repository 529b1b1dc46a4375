#include "metrics/paired_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/random.h"

namespace aligngs {
namespace {

constexpr int kDraws = 10000;         // the interval's ends move by less than 1 % of its width between seeds
constexpr double kTail = 0.025;       // 95 % interval
constexpr uint64_t kSeed = 20251024;  // any constant: an interval is to be the same whenever it is computed

}  // namespace

PairedDifference paired_difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> differences;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (std::isfinite(a[i]) && std::isfinite(b[i])) differences.push_back(b[i] - a[i]);
  }
  PairedDifference out;
  out.pairs = differences.size();
  if (differences.empty()) {
    out.mean = out.low = out.high = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  const double n = static_cast<double>(differences.size());
  for (const double d : differences) out.mean += d / n;
  if (!out.has_interval()) {
    out.low = out.high = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  Random random(kSeed);
  std::vector<double> means(kDraws, 0.0);
  for (double& mean : means) {
    for (size_t i = 0; i < differences.size(); ++i) {
      mean += differences[static_cast<size_t>(random.below(static_cast<int>(differences.size())))] / n;
    }
  }
  std::sort(means.begin(), means.end());
  out.low = means[static_cast<size_t>(kTail * kDraws)];
  out.high = means[static_cast<size_t>((1 - kTail) * kDraws) - 1];
  return out;
}

}  // namespace aligngs
