// Numbers of metrics.json by their dotted names.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace aligngs {

/// The number at a dotted path such as "nvs.psnr"; NaN when there is none (absent, null, or no number).
double number_at(const nlohmann::json& root, const std::string& dotted);

}  // namespace aligngs
