// The one writer and the one reader of metrics.json.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "metrics/run_metrics.h"

namespace aligngs {

/// NaN and infinity have no JSON form: null. Parts that were not measured are null, never a substitute.
nlohmann::json metrics_json(const RunMetrics& metrics);

/// The inverse of metrics_json, also for files of older versions. A number that is absent, null or no number is NaN or
/// empty, and counts of views, classes and samples are then 0. A part that is no object is empty. `labels` has the
/// classes that the file names, sorted; alignments have no similarity. Never throws; what is no object at all is {}.
RunMetrics metrics_from_json(const nlohmann::json& json);

/// Error{kBadInput} when the file is absent or is no JSON object.
RunMetrics read_metrics(const std::filesystem::path& file);

/// The numbers that a person may name: "nvs.psnr", "geometry.surface.pinholes", "semantics.iou.wall". Only finite ones.
std::map<std::string, double> named_figures(const RunMetrics& metrics);

}  // namespace aligngs
