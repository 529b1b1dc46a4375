// Training and everything that follows from it in a run folder, as the plan of the run has it.
#pragma once

#include "cli/command.h"
#include "cli/stages/mesh_stage.h"
#include "metrics/run_metrics.h"
#include "pipeline/run_plan.h"
#include "train/train_run.h"

namespace aligngs {

/// Trains (or resumes), then does the steps of the plan that come after training. A training that had been finished
/// before is not repeated; the later stages are. Prints the summary unless --json is set. Returns what was measured.
RunMetrics run_pipeline(const RunPlan& plan, const TrainOptions& options, const CommandContext& context,
                        const TsdfDeviceFactory& make_tsdf_device = {});

}  // namespace aligngs
