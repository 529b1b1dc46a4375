#include "pipeline/step_forecast.h"

#include <algorithm>
#include <limits>
#include <thread>

#include "core/error.h"
#include "core/log.h"
#include "core/memory_budget.h"
#include "pipeline/room_memory.h"
#include "priors/network_time.h"
#include "priors/scene_priors.h"
#include "priors/semantic_teacher.h"

namespace aligngs {
namespace {

/// Bytes of the network of a step; unknown where its weights are not those that are expected.
std::optional<uint64_t> network_bytes(const PlannedStep& step, const ModelStore& store,
                                      const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  MemoryBudget budget(std::numeric_limits<uint64_t>::max());  // asked for its sum alone
  try {
    if (step.step == RunStep::kClasses)
      add_semantic_memory(budget, store, *step.network, false, photos, options);
    else
      add_depth_memory(budget, store, *step.network, photos, options);
    return budget.total();
  } catch (const Error& error) {
    log_debug("memory of {} is unknown: {}", step.network->name, error.what());
    return std::nullopt;
  }
}

}  // namespace

void forecast_training(const TrainOptions& train, uint64_t pixels, RunPlan& plan) {
  const std::optional<RunRecord> earlier = earlier_run(train.run);
  const uint64_t peak = expected_peak_bytes(earlier);
  for (PlannedStep& step : plan.steps) {
    if (step.step != RunStep::kTrain || step.outlook == Outlook::kLeftOut) continue;
    if (peak > 0)
      step.memory_bytes = peak;
    else if (pixels > 0)
      step.memory_bytes = estimated_training_bytes(pixels);
    if (step.memory_bytes && train.memory_limit > 0)
      step.memory_bytes = std::min(*step.memory_bytes, train.memory_limit);
    if (!earlier || !(earlier->train.iterations_per_second > 0)) continue;
    const int64_t done = plan.begun ? earlier->train.iterations : 0;
    step.seconds =
        double(std::max<int64_t>(plan.config.train.iterations - done, 0)) / earlier->train.iterations_per_second;
  }
}

void forecast_network_time(double rate, RunPlan& plan) {
  for (PlannedStep& step : plan.steps) {
    if (step.network && step.outlook != Outlook::kLeftOut && plan.photos > 0)
      step.seconds = network_seconds(step.network->name, plan.photos, rate);
  }
}

void forecast_steps(const RunRequest& request, const ModelStore& store, const std::vector<NetworkInput>& photos,
                    RunPlan& plan) {
  NetworkMemoryOptions options;
  options.precision = request.photos.precision;
  options.threads = request.train.threads > 0 ? request.train.threads
                                              : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  for (PlannedStep& step : plan.steps) {
    if (step.network && step.outlook != Outlook::kLeftOut && !photos.empty())
      step.memory_bytes = network_bytes(step, store, photos, options);
  }
  plan.photos = photos.size();
  forecast_training(request.train, pixels_of(photos), plan);
}

}  // namespace aligngs
