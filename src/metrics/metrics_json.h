// The one writer of metrics.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "metrics/run_metrics.h"

namespace aligngs {

/// NaN and infinity have no JSON form: null. Parts that were not measured are null, never a substitute.
nlohmann::json metrics_json(const RunMetrics& metrics);

}  // namespace aligngs
