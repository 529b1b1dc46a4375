// The few lines that people read at the end of a command.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace aligngs {

/// PSNR, SSIM, geometry and labels of metrics.json, a line each; what is null says why.
std::string metrics_summary(const nlohmann::json& metrics);

}  // namespace aligngs
