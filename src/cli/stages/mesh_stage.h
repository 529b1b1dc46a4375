// The mesh of a run: rendered (or prior) depth of the training views, fused, extracted, cleaned, labelled.
#pragma once

#include <filesystem>

#include "cli/stages/open_run.h"
#include "mesh/fusion.h"
#include "mesh/mesh_labels.h"

namespace aligngs {

struct MeshStageOptions {
  /// Fuses pred_depths/ of the training views with the run's cameras instead of rendered depth: the yardstick that a
  /// method must beat to have added anything.
  bool from_prior = false;
  std::filesystem::path output;  ///< empty: mesh/mesh.ply of the run
};

struct MeshStageResult {
  std::filesystem::path file;
  FusionReport fusion;
  MeshLabelingReport labels;
};

/// Settings come from the run's config.toml (group mesh). Error{kFailed} when no surface came out.
MeshStageResult mesh_run(OpenRun& run, const MeshStageOptions& options);

}  // namespace aligngs
