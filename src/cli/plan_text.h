// The plan of a run as people and as programs read it: what --dry-run prints.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pipeline/run_plan.h"

namespace aligngs {

/// A line per step: its name, whether it is planned, memory, time and the reason.
std::string plan_text(const RunPlan& plan);
/// {"source", "run", "scene", "begun", "memory_bytes", "steps": [{"step", "outlook", "reason", "network", "terms",
/// "seconds", "memory_bytes"}]}; null is unknown, or none.
nlohmann::json plan_json(const RunPlan& plan);

/// Prints it, as JSON with --json.
void print_plan(const RunPlan& plan, bool json);

}  // namespace aligngs
