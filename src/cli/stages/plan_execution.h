// Carries out the plan of a run (pipeline/run_plan.h), step by step.
#pragma once

#include <functional>

#include "cli/command.h"
#include "cli/stages/mesh_stage.h"
#include "metrics/run_metrics.h"
#include "pipeline/run_plan.h"

namespace aligngs {

struct PlanExecutionOptions {
  nn::Precision precision = nn::Precision::kBfloat16;  ///< of networks for depth and classes
  nn::DeviceFactory make_device = {};                  ///< where these run; empty: the processor
  TsdfDeviceFactory make_fusion_device = {};           ///< the same for fusion
  ScenePhotosOptions photos;                           ///< of the cameras that the plan chose; unused without photos
  std::function<void()> synth;                         ///< makes the synthetic scene; unused without that step
};

/// Everything that a run makes goes below its own folder: the source is never changed. Steps that an earlier one decides
/// are settled when it is done. Returns what was measured.
RunMetrics execute_plan(const RunPlan& plan, const RunRequest& request, const PlanExecutionOptions& options,
                        const ModelStore& store, const CommandContext& context);

}  // namespace aligngs
