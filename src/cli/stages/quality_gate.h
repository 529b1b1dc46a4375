// --fail-under: figures that a run must reach.
#pragma once

#include <string>
#include <vector>

#include "metrics/run_metrics.h"

namespace aligngs {

struct LeastValue {
  std::string figure;  ///< as named_figures() has it: "nvs.psnr"
  double least = 0;    ///< in the figure's unit
};

/// Reads conditions such as "psnr=24" or "geometry.fscore=0.5"; call before long work. Error{kUsage} when one cannot be
/// read, is not finite or names no part of metrics.json. Short names: psnr, ssim, fscore, miou.
std::vector<LeastValue> least_values(const std::vector<std::string>& conditions);

/// Error{kBelow} (status 6) when a figure is lower, Error{kUsage} when the metrics do not have it.
void require_at_least(const RunMetrics& metrics, const std::vector<LeastValue>& values);

}  // namespace aligngs
