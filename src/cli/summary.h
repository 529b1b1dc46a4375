// The few lines that people read at the end of a command.
#pragma once

#include <string>

#include "metrics/run_metrics.h"

namespace aligngs {

/// PSNR, SSIM, geometry and labels, a line each; what was not measured says why.
std::string metrics_summary(const RunMetrics& metrics);

}  // namespace aligngs
