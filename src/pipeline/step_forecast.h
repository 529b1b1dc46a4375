// Memory and time that the steps of a plan are expected to take, as far as something is known about them.
#pragma once

#include <vector>

#include "pipeline/run_plan.h"
#include "priors/network_memory.h"

namespace aligngs {

/// Memory of networks, from the headers of their weights and the sizes of the photos, and that of training. Without
/// photos, as of a video, it stays unknown.
void forecast_steps(const RunRequest& request, const ModelStore& store, const std::vector<NetworkInput>& photos,
                    RunPlan& plan);

/// Training alone: memory of an earlier run in the folder, else by the pixels of the photos, below the limit that is
/// given. Time by the speed of an earlier run in the folder, else unknown.
void forecast_training(const TrainOptions& train, uint64_t pixels, RunPlan& plan);

/// Time of networks on the processor: operations of a photo (priors/network_time.h) times the photos of the plan, at
/// `rate` operations per second. Unknown where the photos or the operations are.
void forecast_network_time(double rate, RunPlan& plan);

}  // namespace aligngs
