// The stages of a whole run in order: train, render, mesh, evaluate, report.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/command.h"
#include "cli/stages/mesh_stage.h"
#include "train/train_run.h"

namespace aligngs {

/// Trains (or resumes), then makes everything else that belongs into a run folder. A training that had been finished
/// before is not repeated; the later stages are. Prints the summary unless --json is set. Returns metrics.json.
nlohmann::json run_pipeline(const TrainOptions& options, const CommandContext& context,
                            const TsdfDeviceFactory& make_tsdf_device = {});

}  // namespace aligngs
