#include "cli/plan_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/print_json.h"
#include "core/progress.h"

namespace aligngs {

std::string plan_text(const RunPlan& plan) {
  std::string text = fmt::format("{:<9} {:<9} {:>9} {:>9}  {}\n", "step", "outlook", "memory", "time", "reason");
  for (const PlannedStep& step : plan.steps) {
    const bool done = step.outlook != Outlook::kLeftOut;
    const std::string memory = step.memory_bytes ? format_bytes(*step.memory_bytes) : "unknown";
    const std::string time = step.seconds ? format_duration(*step.seconds) : "unknown";
    text += fmt::format("{:<9} {:<9} {:>9} {:>9}  {}\n", step_name(step.step), outlook_name(step.outlook),
                        done ? memory : "", done ? time : "", step.reason);
    if (done && !step.terms.empty()) text += fmt::format("{:<40}  {}\n", "", step.terms);
  }
  text += fmt::format("scene     {}\n", plan.scene.string());
  text += fmt::format("memory    {}\n", plan.memory_bytes() > 0
                                            ? "up to " + format_bytes(plan.memory_bytes()) + ", as far as it is known"
                                            : "unknown");
  double seconds = 0;
  for (const PlannedStep& step : plan.steps)
    if (step.outlook != Outlook::kLeftOut) seconds += step.seconds.value_or(0);
  text += fmt::format("time      {}\n", seconds > 0 ? "at least " + format_duration(seconds) : "unknown");
  if (plan.has(RunStep::kTrain) && !plan.step(RunStep::kTrain).seconds)
    text += "          training: no earlier run in the folder tells its speed on this machine\n";
  const std::vector<std::string> unknown = plan.steps_of_unknown_time();
  if (!unknown.empty()) text += fmt::format("          nothing is known of {}\n", fmt::join(unknown, ", "));
  return text + "nothing was done: leave --dry-run out to begin\n";
}

nlohmann::json plan_json(const RunPlan& plan) {
  const auto known = [](const auto& value) { return value ? nlohmann::json(*value) : nlohmann::json(nullptr); };
  nlohmann::json steps = nlohmann::json::array();
  for (const PlannedStep& step : plan.steps) {
    steps.push_back({{"step", step_name(step.step)},
                     {"outlook", outlook_name(step.outlook)},
                     {"reason", step.reason},
                     {"network", step.network ? nlohmann::json(step.network->name) : nlohmann::json(nullptr)},
                     {"terms", step.terms},
                     {"seconds", known(step.seconds)},
                     {"memory_bytes", known(step.memory_bytes)}});
  }
  return {{"source", plan.source.string()},
          {"run", plan.run.string()},
          {"scene", plan.scene.string()},
          {"begun", plan.begun},
          {"memory_bytes", plan.memory_bytes() > 0 ? nlohmann::json(plan.memory_bytes()) : nlohmann::json(nullptr)},
          {"steps", steps}};
}

void print_plan(const RunPlan& plan, bool json) {
  if (json)
    print_json(plan_json(plan));
  else
    std::fputs(plan_text(plan).c_str(), stdout);
}

}  // namespace aligngs
